// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "choices.h"
#include "planar/cutout.h"
#include "progress.h"

namespace py = pybind11;

namespace planar::python {
namespace {

// outline and cutout take the same.
template <typename Result, Result (*make)(const AlphaImage&, const CutoutOptions&)>
Result made_of_image(py::handle alpha, py::handle vertices, std::optional<double> edge,
                     std::optional<double> margin, std::optional<double> rounding, double threshold,
                     const std::string& holes, std::optional<double> smallest, double finest,
                     py::handle progress) {
  CutoutOptions options;
  options.vertices = to_whole("vertices", vertices);
  options.edge = edge;
  options.margin = margin;
  options.rounding = rounding;
  options.threshold = threshold;
  options.holes = to_choice<Holes>("holes", holes, {{"KEEP", Holes::keep}, {"FILL", Holes::fill}});
  options.smallest = smallest;
  options.finest = finest;
  options.progress = to_progress(progress);
  const AlphaImage image = to_alpha("alpha", alpha);
  const py::gil_scoped_release unlocked;
  return make(image, options);
}

Keyed py_key_colour(py::handle pixels, double tolerance) {
  Eigen::Index height = 0, width = 0;
  const Colours colours = to_colours("pixels", pixels, &height, &width);
  const py::gil_scoped_release unlocked;
  return key_colour(colours, height, width, tolerance);
}

std::string cutout_text(const Cutout& value) {
  std::ostringstream text;
  text << "Cutout(points=" << value.points.rows() << ", triangles=" << value.triangles.rows()
       << ", parts=" << value.n_parts << ", edge=" << value.edge << ")";
  return text.str();
}

}  // namespace

void bind_cutout(py::module_& m) {
  auto outline_class =
      py::class_<Outline>(m, "Outline", "Closed polylines round the art of an image.", made_by_the_library())
          .def_readonly("rings", &Outline::rings,
                        "n x 2 each, in pixels from the lower left corner, the art on their left.")
          .def_readonly("edge", &Outline::edge, "Length of edges that the wish comes to.")
          .def_readonly("margin", &Outline::margin, "As used.")
          .def_readonly("rounding", &Outline::rounding, "As used.")
          .def_readonly("sample", &Outline::sample, "Pixels a sample of the image as it was worked on.")
          .def_readonly("islands", &Outline::islands, "Kept, as the outline joins them.")
          .def_readonly("holes", &Outline::holes, "Kept.")
          .def_readonly("dropped_islands", &Outline::dropped_islands, "Islands smaller than the smallest.")
          .def_readonly("dropped_pixels", &Outline::dropped_pixels, "Pixels of dropped islands.")
          .def_readonly("filled_holes", &Outline::filled_holes, "Holes that were filled.");
  outline_class.attr("__module__") = "planar_native";

  auto cutout_class =
      py::class_<Cutout>(m, "Cutout", "A drawing as a mesh.", made_by_the_library())
          .def_readonly("points", &Cutout::points,
                        "n x 2 in pixels from the lower left corner; those of rings first.")
          .def_readonly("triangles", &Cutout::triangles, "m x 3, counter-clockwise.")
          .def_readonly("parts", &Cutout::parts, "The island of each point, n, numbered from 0.")
          .def_readonly("n_parts", &Cutout::n_parts, "Number of islands.")
          .def_readonly("rings", &Cutout::rings, "Vertices along each closed boundary, the art on the left.")
          .def_readonly("outline", &Cutout::outline, "The Outline that it was made from.")
          .def_readonly("edge", &Cutout::edge, "Length of edges where nothing asked for shorter ones.")
          .def_readonly("shortest", &Cutout::shortest, "Length below which edges were not shortened.")
          .def_readonly("reached", &Cutout::reached,
                        "Whether there are as many vertices as wished, within a quarter.")
          .def_readonly("said", &Cutout::said, "Sentences for who made the wish; mostly none.")
          .def("__repr__", &cutout_text);
  cutout_class.attr("__module__") = "planar_native";

  auto keyed_class =
      py::class_<Keyed>(m, "Keyed", "The alpha of an opaque image whose border is plain.",
                        made_by_the_library())
          .def_readonly("alpha", &Keyed::alpha, "h x w, 0 where the colour of the border reaches, else 1.")
          .def_readonly("keyed", &Keyed::keyed, "False: alpha is 1 everywhere.")
          .def_readonly("colour", &Keyed::colour, "Of the border: red, green, blue.")
          .def_readonly("said", &Keyed::said, "Why nothing was keyed; empty if it was.");
  keyed_class.attr("__module__") = "planar_native";

  m.def(
      "cutout", &made_of_image<Cutout, cutout>, py::arg("alpha"), py::kw_only(), py::arg("vertices") = 1500,
      py::arg("edge") = py::none(), py::arg("margin") = py::none(), py::arg("rounding") = py::none(),
      py::arg("threshold") = 0.05, py::arg("holes") = "KEEP", py::arg("smallest") = py::none(),
      py::arg("finest") = 6.0, py::arg("progress") = py::none(),
      R"(cutout(alpha, *, vertices=1500, edge=None, margin=None, rounding=None, threshold=0.05, holes="KEEP", smallest=None, finest=6.0, progress=None)

An even mesh of an image's art, ready to be posed: every pixel of it inside, two rows of triangles across thin parts.

alpha h x w, rows from the bottom as Blender's pixels: numbers from 0 to 1, truths, or bytes of 0 to 255. Lengths are in
pixels. vertices is what is wished; edge, the length of edges where nothing asks for shorter ones, counts instead if it is
given. margin: how far the outline stays away from the art (None: a tenth of the edge; never less than two samples, see
Outline.sample). rounding: gaps and notches narrower than twice this are filled (None: the margin). Pixels above threshold
are art. holes "KEEP" or "FILL"; those too small for a triangle are always filled. smallest: islands of a smaller share of
the art are left out (None: specks, 3e-4 at most). Edges are shortened to 1/finest at most.

progress(share) is called now and then; it answers True, False or None, and False raises Cancelled.
Returns a Cutout, whose `said` has what who made the wish should know. Raises ValueError (shape, dtype, numbers, an empty or too large
image, nothing above the threshold), SolveError and Cancelled.)");
  m.def(
      "outline", &made_of_image<Outline, outline>, py::arg("alpha"), py::kw_only(),
      py::arg("vertices") = 1500, py::arg("edge") = py::none(), py::arg("margin") = py::none(),
      py::arg("rounding") = py::none(), py::arg("threshold") = 0.05, py::arg("holes") = "KEEP",
      py::arg("smallest") = py::none(), py::arg("finest") = 6.0, py::arg("progress") = py::none(),
      R"(outline(alpha, *, vertices=1500, edge=None, margin=None, rounding=None, threshold=0.05, holes="KEEP", smallest=None, finest=6.0, progress=None)

The outline that cutout fills, without filling it. Arguments and errors as cutout. Returns an Outline.)");
  m.def("key_colour", &py_key_colour, py::arg("pixels"), py::kw_only(), py::arg("tolerance") = 24.0 / 255.0,
        R"(key_colour(pixels, *, tolerance=24/255)

An alpha for an opaque image: the colour of its border is flooded from the border inwards, over pixels within tolerance of it in
each channel. It must be the colour of four fifths of the border.

pixels h x w x 3 or h x w x 4 (the fourth is not looked at), rows in any order, real numbers, or bytes that stand for 0 to 1. Returns
a Keyed; where nothing could be keyed, its alpha is 1 everywhere and `said` tells why. Raises ValueError.)");
}

}  // namespace planar::python
