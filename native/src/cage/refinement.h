// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cage/carried_mesh.h"

namespace planar {

/// The coarse mesh with its edges halved near some dense vertices, until they are as long as the dense ones
/// there, growing by 0.4 of the distance; by more where it would become half as large again. What pulls at a
/// point deforms a mesh the more the finer it is there (by the logarithm of the length of edges), so that
/// pins on a coarse mesh are too stiff. The vertices of before come first.
Coarse refined_near(const Points& dense, const Coarse& coarse, const std::vector<int>& vertices);

}  // namespace planar
