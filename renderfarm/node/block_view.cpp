// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/block_view.h"

#include <algorithm>
#include <span>

#include "common/wire/convert.h"

namespace cyclorama::node {
namespace {

/// Precondition: validate() accepted the view.
render::RenderQuality quality_of(const wire::View& view) {
  render::RenderQuality quality;
  quality.samples = static_cast<int>(view.samples());
  quality.first_sample = static_cast<int>(view.first_sample());
  quality.sequence = static_cast<int>(view.sequence());
  quality.bounces = static_cast<int>(view.bounces());
  if (view.light_samples() > 0) quality.light_samples = static_cast<int>(view.light_samples());
  quality.firefly_limit = view.firefly_limit();
  quality.adaptive_error = view.adaptive_error();
  if (view.adaptive_minimum() > 0) quality.adaptive_minimum = static_cast<int>(view.adaptive_minimum());
  quality.stored_light = view.stored_light();
  return quality;
}

}  // namespace

Result<render::PanoramaView> view_of(const wire::RenderBlock& block) {
  TRY(validate(block.view()));
  if ((block.view().stored_light() || block.view().prior_samples() > 0) && block.view().light().empty()) {
    return Error(ErrorCode::kInvalidArgument, "view.light is empty, but the view reads stored light");
  }
  TRY_ASSIGN(const Projection picture, from_wire(block.view().panorama()));
  wire::Tile whole;
  whole.set_x_px(block.x_px());
  whole.set_y_px(block.y_px());
  whole.set_width_px(block.width_px());
  whole.set_height_px(block.height_px());
  TRY(validate(whole, picture.width_px(), picture.height_px()));
  const auto levels = static_cast<std::size_t>(block.view().lamp_levels_size());
  // The view's number is the seed: noise changes from frame to frame and is the same on every node.
  render::PanoramaView view;
  view.eye = from_wire(block.view().eye_m());
  view.heading_rad = block.view().heading_rad();
  view.quality = quality_of(block.view());
  view.seed = block.view().number();
  view.depth = block.view().depth();
  view.lamps = scene::levels_of(std::span(block.view().lamp_levels().data(), levels));
  const auto* const panorama = std::get_if<Panorama>(&picture.shape);
  if (panorama != nullptr && picture.stacked() == 1) {
    view.panorama = *panorama;
  } else {
    view.projection = picture;
  }
  return view;
}

PixelRect rect_of(const wire::RenderBlock& block) {
  return {static_cast<int>(block.x_px()), static_cast<int>(block.y_px()), static_cast<int>(block.width_px()),
          static_cast<int>(block.height_px())};
}

JpegOptions jpeg_options_of(const wire::RenderBlock& block) {
  return {static_cast<int>(block.view().jpeg_quality()), block.view().subsample_chroma()};
}

float prior_weight_of(const wire::RenderBlock& block) {
  const wire::View& view = block.view();
  if (view.prior_samples() == 0 || view.sequence() == 0) return 0.0f;
  const auto samples = static_cast<float>(view.first_sample() + view.samples());
  return view.prior_weight() * std::max(0.0f, 1.0f - samples / static_cast<float>(view.sequence()));
}

std::string picture_name_of(const wire::RenderBlock& block) {
  wire::View view = block.view();
  view.clear_samples();
  view.clear_first_sample();
  return block.scene() + '\n' + view.SerializeAsString();
}

}  // namespace cyclorama::node
