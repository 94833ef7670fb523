// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include "linear/sparse_solver.h"
#include "mesh/mesh.h"
#include "planar/akvf.h"
#include "planar/handle.h"

/// The call throws std::invalid_argument with these words in its message.
#define EXPECT_REFUSAL(call, words)                                                      \
  try {                                                                                  \
    (void)(call);                                                                        \
    ADD_FAILURE() << "accepted: " #call;                                                 \
  } catch (const std::invalid_argument& error) {                                         \
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what(); \
  }

/// Meshes and fields that the tests share.
namespace planar::testing {

using Complex = std::complex<double>;

struct Shape {
  Points vertices;
  Triangles triangles;
};

/// A unit square of side×side vertices, its vertices moved about by up to a fifth of a cell, alternate
/// triangles turned round.
Shape grid(int side, unsigned seed = 1);

/// Both shapes as one mesh, the second one after the first.
Shape joined(const Shape& a, const Shape& b);

Shape moved(Shape shape, double x, double y);

/// A ring of two rows of `n` vertices: a mesh all of whose vertices are on the boundary, with a hole.
Shape ring(int n);

Points random_points(Eigen::Index n, unsigned seed);

Handles at(const Shape& shape, const std::vector<int>& vertices);

Handles inside(const Shape& shape, const std::vector<int>& triangles, double a = 0.2, double b = 0.3);

/// Velocities of the rigid field that turns with `rate` about the origin and drifts.
Points rigid_field(const Points& x, double rate, double drift_x, double drift_y);

/// x turned by `angle` about the origin, then moved.
Points rigid_motion(const Points& x, double angle, double dx, double dy);

Eigen::VectorXd flat(const Points& u);

Points rows(const Eigen::VectorXd& u);

std::vector<Backend> backends();

}  // namespace planar::testing
