// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/mesh.h"

namespace planar {

/// Of a mesh's edges: ½ Σ stiffness cot(opposite angle) over the triangles of an edge [ARAP09, section 6],
/// clamped at 0, where Delaunay's condition fails. A finer region then counts no more than a coarse one.
///
/// Triangles thinner than 1e-5 of their longest side have cotangents as if they were as thick as that; and no
/// weight is below 1e-9, so that nothing comes loose where all angles are hopeless.
///
/// \param stiffness m factors above 0, or empty: all 1
Eigen::VectorXd cotangent_weights(const Mesh& mesh, const RestOf& rest_of,
                                  const Eigen::VectorXd& stiffness = {});

/// Of a mesh's edges: 1 [ARAP09 1], times the mean stiffness of its triangles.
Eigen::VectorXd uniform_weights(const Mesh& mesh, const Eigen::VectorXd& stiffness = {});

}  // namespace planar
