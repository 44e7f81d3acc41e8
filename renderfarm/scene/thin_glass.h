// SPDX-License-Identifier: Apache-2.0
/// Finds bodies of glass that are thin plates, such as the panes of a display case with their real thickness.
#pragma once

#include <optional>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Returns the mean thickness of a closed mesh that is a plate or a thin shell: through nearly all of its area a
/// perpendicular line leaves it soon and by a parallel surface. Null for every other mesh, such as a lens or a solid
/// block. `metres_per_unit` is the scale at which the mesh is placed. Takes up to a tenth of a second. Reentrant.
[[nodiscard]] std::optional<double> plate_thickness_m(const Mesh& mesh, double metres_per_unit);

/// Makes thin surfaces of the faces of clear plates: both faces reflect and absorb as before, but light crosses them
/// without refraction. The difference is a shift of what is behind by about a third of the thickness. In return, light
/// of any lamp reaches what is behind: shadow rays cross thin glass only. Notes each such material. `model` is in
/// metres.
void make_plates_thin(Model* model);

}  // namespace cyclorama::scene
