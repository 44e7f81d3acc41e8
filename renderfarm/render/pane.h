// SPDX-License-Identifier: Apache-2.0
/// Panes: thin, smooth glass, such as that of a vitrine. Light crosses it in a straight line, so a shadow ray may too,
/// weakened by what the glass reflects and absorbs. Without this, lamps light what stands behind glass only where a
/// scattered ray happens to meet them, and never if they have no size.
#pragma once

#include "renderfarm/render/path_batch.h"
#include "renderfarm/render/trace_scene.h"

namespace cyclorama::render {

/// True if any part of a thin surface of this material may let light straight through. `level` is surface_level_of().
[[nodiscard]] bool is_pane(const scene::Material& material, SurfaceLevel level);

/// Multiplies the light of each unoccluded ray of batch.shadow_rays by what the panes on its way let through.
/// Precondition: the rays are traced, and scene.panes is not null.
void cross_panes(const TraceScene& scene, PathBatch& batch);

}  // namespace cyclorama::render
