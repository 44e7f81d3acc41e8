// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"
#include "appliance/warp/warp_mesh.h"

namespace cyclorama::display {

/// A mesh's triangles, three indices each, by the effect of the mask. Triangles that the mask blackens and that get no
/// black lift are omitted; a projector that extends past the wall has many of them.
struct LitTriangles {
  std::vector<std::uint32_t> whole;   ///< The mask is 1 at all of their pixels.
  std::vector<std::uint32_t> masked;  ///< All others.
};

/// Precondition: mask, mesh and black lift, if there is any, have the same size.
[[nodiscard]] LitTriangles lit_triangles(const warp::WarpMesh& mesh, const warp::MaskImage& mask,
                                         const warp::BlackLiftImage* black_lift = nullptr);

}  // namespace cyclorama::display
