// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "support.h"

/// Dense algebra to compare with. It stands in one source, as Eigen's dense decompositions take longer to
/// compile than what is tested.
namespace planar::testing {

/// x of a x = b; a is symmetric.
Eigen::MatrixXd solved(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// x of least |a x - b|, itself the least there is.
Eigen::VectorXcd least_squares(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b);

/// Those of a symmetric matrix, ascending.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

/// A symmetric matrix without its negative eigenvalues.
Eigen::MatrixXd positive_part(const Eigen::MatrixXd& symmetric);

Eigen::Index rank(const Eigen::MatrixXd& matrix);

/// The rotation R of largest tr(R s), by singular values.
Eigen::MatrixXd dense_rotation(const Eigen::MatrixXd& s);

/// P of (5)-(7), dense, in unknowns (x0, y0, x1, y1, ...), straight from the hat functions' gradients.
Eigen::MatrixXd dense_p(const Points& x, const Triangles& triangles, const Eigen::VectorXd& stiffness = {});

Eigen::MatrixXd dense_k(const Points& x, const Triangles& triangles, const Eigen::VectorXd& stiffness = {});

/// C: 2k×2n, takes a field to the handles.
Eigen::MatrixXd dense_c(const Handles& handles, Eigen::Index n);

/// (7), by dense algebra.
Points dense_soft(const Shape& shape, const Handles& handles, const Points& velocities, double pin_weight,
                  const Eigen::VectorXd& stiffness = {});

/// (8), by dense algebra: the field keeps its values on the boundary.
Points dense_dirichlet(const Shape& shape, const Points& field, const Eigen::VectorXd& stiffness = {});

}  // namespace planar::testing
