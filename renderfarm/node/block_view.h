// SPDX-License-Identifier: Apache-2.0
/// Reads a RenderBlock from the wire. A node validates every message itself, although the coordinator did so, too.
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

// Precondition of the following: view_of() accepted the block.

[[nodiscard]] PixelRect rect_of(const wire::RenderBlock& block);
[[nodiscard]] JpegOptions jpeg_options_of(const wire::RenderBlock& block);
/// Returns the number of samples for which a picture at rest counts the stored light that it began with: of a picture
/// with all its samples, 0.
[[nodiscard]] float prior_weight_of(const wire::RenderBlock& block);
/// Returns a name of everything that determines the picture's samples, for FilmStore.
[[nodiscard]] std::string picture_name_of(const wire::RenderBlock& block);

}  // namespace cyclorama::node
