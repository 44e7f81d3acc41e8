// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/kernel.h"

namespace cyclorama::render {

/// Adds the light of the splats that the rays of batch.current() cross before they hit a surface, and attenuates the
/// rays. Meshes cast shadows on splats: the light stored in a splat is reduced by the share of the scene's light that
/// meshes block there. `is_camera` means that these are camera rays, whose depth is recorded if the view requests it.
/// Precondition: the rays have been traced, no shadow rays are queued, and scene.splats is not null.
void cross_splats(const TraceScene& scene, const TraceView& view, bool is_camera, PathBatch& batch, CellFilm& film);

/// Returns the radiance of splats. If nothing is behind them (`is_alone`), their code values become those of the
/// picture, as in the original program, which blends with black. Otherwise they cover a part of the background in
/// linear light, so that a splat in front of a surface of the same colour changes nothing.
[[nodiscard]] Vec3 radiance_of_splats(const Vec3& colour, float transmittance, bool is_linear, bool is_alone);

}  // namespace cyclorama::render
