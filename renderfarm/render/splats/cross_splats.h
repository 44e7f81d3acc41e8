// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/kernel.h"

namespace cyclorama::render {

/// Adds the light of the splats that the rays of batch.current() cross before they hit a surface, and weakens the rays by
/// them. Meshes cast shadows on splats: the light of a splat, which has no lamps of its own, shrinks as the light of the
/// scene does there. `is_camera`: the rays are the eye's, whose depth is noted if the view requests it.
/// Precondition: the rays are traced, no shadow ray waits, and scene.splats is not null.
void cross_splats(const TraceScene& scene, const TraceView& view, bool is_camera, PathBatch& batch, CellFilm& film);

/// Returns the radiance that splats show. Before nothing (`is_alone`) their code values are those of the picture, as in
/// the original program, which blends with black; before something they cover their part of it in linear light, so that
/// a splat over a surface of its own colour changes nothing.
[[nodiscard]] Vec3 radiance_of_splats(const Vec3& colour, float transmittance, bool is_linear, bool is_alone);

}  // namespace cyclorama::render
