// SPDX-License-Identifier: Apache-2.0
/// What a RenderBlock from the wire asks for. The coordinator checked it too; a node believes nobody.
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/image/jpeg.h"
#include "common/image/pixel_rect.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama::node {

/// The picture to be rendered, a part of which the block is. kInvalidArgument names the field.
Result<render::PanoramaView> view_of(const wire::RenderBlock& block);

// Precondition of the following: view_of() took the block.

[[nodiscard]] PixelRect rect_of(const wire::RenderBlock& block);
[[nodiscard]] JpegOptions jpeg_options_of(const wire::RenderBlock& block);
/// Names all that decides the samples of the picture, for FilmStore.
[[nodiscard]] std::string picture_name_of(const wire::RenderBlock& block);

}  // namespace cyclorama::node
