// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/tile_sender.h"

#include <utility>

#include "common/base/cpu_time.h"

namespace cyclorama::node {
namespace {

/// Returns the report, or the reason why the tile cannot be encoded. The coordinator would refuse it without pixels, so
/// the report has none then.
wire::NodeReport encoded(const RenderedTile& tile, JpegEncoder& encoder, std::string* ret_error) {
  wire::NodeReport report;
  wire::BlockTile* const message = report.mutable_tile();
  message->set_block(tile.block);
  message->mutable_tile()->set_view_number(tile.view_number);
  message->mutable_tile()->set_x_px(static_cast<std::uint32_t>(tile.rect.x));
  message->mutable_tile()->set_y_px(static_cast<std::uint32_t>(tile.rect.y));
  message->mutable_tile()->set_width_px(static_cast<std::uint32_t>(tile.rect.width));
  message->mutable_tile()->set_height_px(static_cast<std::uint32_t>(tile.rect.height));
  if (const auto jpeg = encoder.encode(tile.pixels, tile.options)) {
    message->mutable_tile()->set_jpeg(jpeg->data(), jpeg->size());
  } else {
    *ret_error = jpeg.error().message();
  }
  if (!tile.depth.empty()) message->mutable_tile()->set_depth(encode_inverse_depth(tile.depth));
  return report;
}

}  // namespace

std::vector<wire::NodeReport> TileSender::reports_of(std::vector<NodeLink::Outgoing> items) {
  std::vector<wire::NodeReport> reports(items.size());
  std::vector<Encoding> costs(items.size());
  if (encoders_.size() < items.size()) encoders_.resize(items.size());
  const auto encode = [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const auto* const tile = std::get_if<RenderedTile>(&items[index]);
    if (tile == nullptr) return;
    const double begun = thread_cpu_seconds();
    reports[index] = encoded(*tile, encoders_[index], &costs[index].error);
    costs[index].cpu_seconds = thread_cpu_seconds() - begun;
  };
  if (items.size() == 1) {
    encode(0);  // A report, or the only tile, does not wait for a place among the crew.
  } else {
    crew_.run(static_cast<int>(items.size()), encode);
  }
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (auto* const report = std::get_if<wire::NodeReport>(&items[i])) {
      reports[i] = std::move(*report);
    } else if (const auto* const tile = std::get_if<RenderedTile>(&items[i])) {
      Encoding& encoding = blocks_[tile->block];
      encoding.cpu_seconds += costs[i].cpu_seconds;
      if (!costs[i].error.empty()) encoding.error = std::move(costs[i].error);
    } else {
      reports[i] = end_of(std::get<RenderedBlock>(items[i]));
    }
  }
  return reports;
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
