// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense.h"

#include <Eigen/Dense>

#include "mesh/mesh.h"

namespace planar::testing {

Eigen::MatrixXd solved(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a.ldlt().solve(b); }

Eigen::VectorXcd least_squares(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd positive_part(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

Eigen::Index rank(const Eigen::MatrixXd& matrix) { return matrix.fullPivLu().rank(); }

Eigen::MatrixXd dense_rotation(const Eigen::MatrixXd& s) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(s, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::VectorXd sign = Eigen::VectorXd::Ones(s.rows());
  sign[s.rows() - 1] = (svd.matrixV() * svd.matrixU().transpose()).determinant() > 0.0 ? 1.0 : -1.0;
  return svd.matrixV() * sign.asDiagonal() * svd.matrixU().transpose();
}

Eigen::MatrixXd dense_p(const Points& x, const Triangles& triangles, const Eigen::VectorXd& stiffness) {
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(3 * triangles.rows(), 2 * x.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    Eigen::Matrix3d corners;
    for (int c = 0; c < 3; ++c) corners.row(c) << 1.0, x(triangles(t, c), 0), x(triangles(t, c), 1);
    const Eigen::Matrix3d coefficients =
        corners.inverse();  // of the hat functions 1, x, y; a column for each corner
    const double weight =
        std::sqrt(std::abs(corners.determinant()) / 2.0 * (stiffness.size() ? stiffness[t] : 1.0));
    for (int c = 0; c < 3; ++c) {
      const double gx = weight * coefficients(1, c), gy = weight * coefficients(2, c);
      const Eigen::Index u = 2 * triangles(t, c), v = u + 1;
      p(3 * t, u) = 2.0 * gx;
      p(3 * t + 1, u) = std::sqrt(2.0) * gy;
      p(3 * t + 1, v) = std::sqrt(2.0) * gx;
      p(3 * t + 2, v) = 2.0 * gy;
    }
  }
  return p;
}

Eigen::MatrixXd dense_k(const Points& x, const Triangles& triangles, const Eigen::VectorXd& stiffness) {
  const Eigen::MatrixXd p = dense_p(x, triangles, stiffness);
  return p.transpose() * p;
}

Eigen::MatrixXd dense_c(const Handles& handles, Eigen::Index n) {
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(2 * handles.size(), 2 * n);
  for (Eigen::Index i = 0; i < handles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      c(2 * i, 2 * handles.vertices(i, corner)) += handles.weights(i, corner);
      c(2 * i + 1, 2 * handles.vertices(i, corner) + 1) += handles.weights(i, corner);
    }
  }
  return c;
}

Points dense_soft(const Shape& shape, const Handles& handles, const Points& velocities, double pin_weight,
                  const Eigen::VectorXd& stiffness) {
  const Eigen::MatrixXd c = dense_c(handles, shape.vertices.rows());
  const Eigen::MatrixXd k = dense_k(shape.vertices, shape.triangles, stiffness);
  return rows(
      (k + pin_weight * c.transpose() * c).ldlt().solve(pin_weight * c.transpose() * flat(velocities)));
}

Points dense_dirichlet(const Shape& shape, const Points& field, const Eigen::VectorXd& stiffness) {
  const Mesh mesh(shape.vertices.rows(), shape.triangles);
  const Eigen::MatrixXd k = dense_k(shape.vertices, shape.triangles, stiffness);
  std::vector<int> inner, outer;
  for (int v = 0; v < mesh.n_vertices; ++v) {
    auto& side = mesh.interior[static_cast<std::size_t>(v)] ? inner : outer;
    side.insert(side.end(), {2 * v, 2 * v + 1});
  }
  Eigen::VectorXd u = flat(field);
  const Eigen::MatrixXd inner_k = k(inner, inner);
  const Eigen::MatrixXd coupling = k(inner, outer);
  const Eigen::VectorXd right = -coupling * Eigen::VectorXd(u(outer));
  u(inner) = inner_k.ldlt().solve(right).eval();
  return rows(u);
}

}  // namespace planar::testing
