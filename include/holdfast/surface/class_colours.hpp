// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// Replaces the colours of a mesh by those of the classes of its vertices, as the viewer shows them: light grey for the
/// background, dark grey where the class is unknown, and six colours in turn for the others.
void colour_by_class(TriangleMesh& mesh);

}  // namespace holdfast
