// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice/lattice_springs.h"

#include <Eigen/Geometry>
#include <utility>

#include "base/complex_rows.h"
#include "base/index.h"
#include "energy/rigid_fit.h"
#include "lattice/nearest_rotation.h"

namespace planar {

template <int D>
LatticeSprings<D>::LatticeSprings(Eigen::Index n_points)
    : rows(0, n_points),
      rest(0, D),
      targets(0, D),
      point_rest(0, D),
      point_targets(0, D),
      is_point(at(n_points), 0),
      locked(at(n_points), 0) {}

template <int D>
Rows<D> LatticeSprings<D>::places(const Rows<D>& d) const {
  Rows<D> u;
  product<D>(rows, d, u);
  return rest + u;
}

template <int D>
double LatticeSprings<D>::value(const Rows<D>& d, Rows<D>* gradient) const {
  const Rows<D> left = places(d) - targets;
  double sum = (left.rowwise().squaredNorm().array() * weight.array()).sum();
  if (gradient != nullptr) {
    const Rows<D> forces = 2.0 * weight.asDiagonal() * left;
    add_transposed<D>(rows, forces, *gradient);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Eigen::Matrix<double, 1, D> off = point_rest.row(row) + d.row(points[i]) - point_targets.row(row);
    sum += point_weight * off.squaredNorm();
    if (gradient != nullptr) gradient->row(points[i]) += 2.0 * point_weight * off;
  }
  return sum;
}

namespace {

Eigen::Matrix2d best_turn(const Rows<2>& from, const Rows<2>& to, const Eigen::VectorXd& weight) {
  std::vector<PointPair> pairs;
  for (Eigen::Index i = 0; i < from.rows(); ++i) {
    pairs.push_back({0, weight[i], complex_row(from, i), complex_row(to, i)});
  }
  const std::complex<double> turn = fit_rigid_motions(1, pairs)[0].turn;
  Eigen::Matrix2d result;
  result << turn.real(), -turn.imag(), turn.imag(), turn.real();
  return result;
}

Eigen::Matrix3d best_turn(const Rows<3>& from, const Rows<3>& to, const Eigen::VectorXd& weight) {
  const Eigen::RowVector3d from_mean = weight.transpose() * from / weight.sum();
  const Eigen::RowVector3d to_mean = weight.transpose() * to / weight.sum();
  const Rows<3> p = from.rowwise() - from_mean, q = to.rowwise() - to_mean;
  const Eigen::Matrix3d s = p.transpose() * weight.asDiagonal() * q;
  // What rounding makes of S where it is 0.
  const double far = std::max(from.cwiseAbs().maxCoeff(), to.cwiseAbs().maxCoeff());
  const double spread = std::max(p.cwiseAbs().maxCoeff(), q.cwiseAbs().maxCoeff());
  if (!(s.norm() > 1e-14 * far * spread * weight.sum())) return Eigen::Matrix3d::Identity();
  // The norm of the matrix of cofactors is near the product of the two largest singular values.
  Eigen::Matrix3d cofactors;
  cofactors << s.col(1).cross(s.col(2)), s.col(2).cross(s.col(0)), s.col(0).cross(s.col(1));
  if (cofactors.norm() <= 1e-9 * s.squaredNorm()) {
    // All on a line, S = σ u vᵀ: nothing is turned about it.
    Eigen::Index row = 0, column = 0;
    s.cwiseAbs().maxCoeff(&row, &column);
    const Eigen::Vector3d u = (s.col(column) * s(row, column)).normalized(), v = s.row(row).normalized();
    const Eigen::Vector3d middle = (u + v).normalized();
    Eigen::Quaterniond turn;
    turn.w() = u.dot(middle);
    turn.vec() = u.cross(middle);
    if ((u + v).norm() < 1e-7) {  // back to front
      turn.w() = 0.0;
      turn.vec() = u.unitOrthogonal();
    }
    return turn.toRotationMatrix();
  }
  return nearest_rotation(s);
}

}  // namespace

template <int D>
Motion<D> fit_motion(const Rows<D>& from, const Rows<D>& to, const Eigen::VectorXd& weight) {
  Motion<D> motion;
  motion.from = weight.transpose() * from / weight.sum();
  motion.to = weight.transpose() * to / weight.sum();
  motion.turn = best_turn(from, to, weight);
  return motion;
}

template <int D>
Rows<D> moved_points(const Motion<D>& motion, const Rows<D>& lattice_rest, const Rows<D>& d,
                     const std::vector<char>& locked) {
  Rows<D> result = d;
  for (Eigen::Index p = 0; p < d.rows(); ++p) {
    if (!locked[at(p)]) result.row(p) = motion.at(lattice_rest.row(p) + d.row(p)) - lattice_rest.row(p);
  }
  return result;
}

template <int D>
std::vector<Rows<D>> starts(const LatticeSprings<D>& springs, const Rows<D>& lattice_rest, const Rows<D>& d) {
  const auto n_rows = springs.rows.rows(), n_points = static_cast<Eigen::Index>(springs.points.size());
  Rows<D> rest(n_rows + n_points, D), now = rest, to = rest;
  Eigen::VectorXd weight(n_rows + n_points);
  rest << springs.rest, springs.point_rest;
  now << springs.places(d), springs.point_rest + d(springs.points, Eigen::all);
  to << springs.targets, springs.point_targets;
  weight << springs.weight, Eigen::VectorXd::Constant(n_points, springs.point_weight);
  Rows<D> none = d;
  for (Eigen::Index p = 0; p < d.rows(); ++p) {
    if (!springs.locked[at(p)]) none.row(p).setZero();
  }
  std::vector<Rows<D>> result{d};
  result.push_back(moved_points<D>(fit_motion<D>(now, to, weight), lattice_rest, d, springs.locked));
  result.push_back(moved_points<D>(fit_motion<D>(rest, to, weight), lattice_rest, none, springs.locked));
  result.push_back(std::move(none));
  return result;
}

template struct LatticeSprings<2>;
template struct LatticeSprings<3>;
template Motion<2> fit_motion<2>(const Rows<2>&, const Rows<2>&, const Eigen::VectorXd&);
template Motion<3> fit_motion<3>(const Rows<3>&, const Rows<3>&, const Eigen::VectorXd&);
template Rows<2> moved_points<2>(const Motion<2>&, const Rows<2>&, const Rows<2>&, const std::vector<char>&);
template Rows<3> moved_points<3>(const Motion<3>&, const Rows<3>&, const Rows<3>&, const std::vector<char>&);
template std::vector<Rows<2>> starts<2>(const LatticeSprings<2>&, const Rows<2>&, const Rows<2>&);
template std::vector<Rows<3>> starts<3>(const LatticeSprings<3>&, const Rows<3>&, const Rows<3>&);

}  // namespace planar
