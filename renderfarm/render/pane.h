// SPDX-License-Identifier: Apache-2.0
/// Panes: thin, smooth glass, such as that of a display case. Light crosses a pane in a straight line, so shadow rays
/// may cross it too, attenuated by the reflection and absorption of the glass. If they did not, an object behind glass
/// is lit only by scattered rays that happen to hit a lamp, and never by a lamp without size.
#pragma once

#include "renderfarm/render/path_batch.h"
#include "renderfarm/render/trace_scene.h"

namespace cyclorama::render {

/// Returns true if any part of a thin surface of this material may let light straight through. `level` is the
/// material's surface_level_of().
[[nodiscard]] bool is_pane(const scene::Material& material, SurfaceLevel level);

/// Multiplies the light of each unoccluded ray of batch.shadow_rays by the transmittance of the panes on its way.
/// Precondition: the rays have been traced, and scene.panes is not null.
void cross_panes(const TraceScene& scene, PathBatch& batch);

}  // namespace cyclorama::render
