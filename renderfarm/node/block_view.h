// SPDX-License-Identifier: Apache-2.0
/// Reads a RenderBlock from the wire. Each node validates every message, although the coordinator has validated it,
/// too.
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/image/jpeg.h"
#include "common/image/pixel_rect.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama::node {

/// Returns the view of the whole picture that the block is a part of. Errors: kInvalidArgument, naming the field.
Result<render::PanoramaView> view_of(const wire::RenderBlock& block);

// Precondition of the following functions: view_of() accepted the block.

[[nodiscard]] PixelRect rect_of(const wire::RenderBlock& block);
[[nodiscard]] JpegOptions jpeg_options_of(const wire::RenderBlock& block);
/// Returns the number of samples that the stored light counts for in a picture at rest that began with it; 0 for a
/// picture with all its samples.
[[nodiscard]] float prior_weight_of(const wire::RenderBlock& block);
/// Returns a name for everything that determines the picture's samples, as a key for FilmStore.
[[nodiscard]] std::string picture_name_of(const wire::RenderBlock& block);

}  // namespace cyclorama::node
