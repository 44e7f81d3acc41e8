// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/tile_sender.h"

#include <utility>

#include "common/base/cpu_time.h"

namespace cyclorama::node {

wire::NodeReport TileSender::report_of(NodeLink::Outgoing item) {
  if (auto* const report = std::get_if<wire::NodeReport>(&item)) return std::move(*report);
  if (const auto* const tile = std::get_if<RenderedTile>(&item)) return encoded(*tile);
  return end_of(std::get<RenderedBlock>(item));
}

wire::NodeReport TileSender::encoded(const RenderedTile& tile) {
  const double begun = thread_cpu_seconds();
  Encoding& encoding = blocks_[tile.block];
  wire::NodeReport report;
  wire::BlockTile* const message = report.mutable_tile();
  message->set_block(tile.block);
  message->mutable_tile()->set_view_number(tile.view_number);
  message->mutable_tile()->set_x_px(static_cast<std::uint32_t>(tile.rect.x));
  message->mutable_tile()->set_y_px(static_cast<std::uint32_t>(tile.rect.y));
  message->mutable_tile()->set_width_px(static_cast<std::uint32_t>(tile.rect.width));
  message->mutable_tile()->set_height_px(static_cast<std::uint32_t>(tile.rect.height));
  if (const auto jpeg = encoder_.encode(tile.pixels, tile.options)) {
    message->mutable_tile()->set_jpeg(jpeg->data(), jpeg->size());
  } else {
    // The coordinator refuses the tile, since it is empty; the block's end reports the reason.
    encoding.error = jpeg.error().message();
  }
  if (!tile.depth.empty()) message->mutable_tile()->set_depth(encode_inverse_depth(tile.depth));
  encoding.cpu_seconds += thread_cpu_seconds() - begun;
  return report;
}

wire::NodeReport TileSender::end_of(const RenderedBlock& block) {
  wire::NodeReport report;
  wire::BlockEnd* const end = report.mutable_end();
  end->set_block(block.block);
  end->set_render_cpu_seconds(block.cost.cpu_seconds);
  end->set_wall_seconds(block.cost.wall_seconds);
  end->set_waited_seconds(block.waited_seconds);
  end->set_rays(block.cost.rays);
  for (const float seconds : block.cost.cell_cpu_seconds) end->add_cell_cpu_seconds(seconds);
  const auto encoding = blocks_.extract(block.block);
  end->set_encode_cpu_seconds(encoding ? encoding.mapped().cpu_seconds : 0.0);
  end->set_error(block.error.empty() && encoding ? encoding.mapped().error : block.error);
  return report;
}

}  // namespace cyclorama::node
