// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/shared_farm/simulated_node.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/check.h"
#include "common/image/cells.h"
#include "renderfarm/balance/tiles.h"
#include "renderfarm/node/block_view.h"
#include "renderfarm/render/sample_pieces.h"

namespace cyclorama {
namespace {

constexpr double kMinPieceSeconds = 0.005;
constexpr double kMaxPieceSeconds = 0.05;
constexpr double kProgressSeconds = 0.05;
/// Thread time of one segment of a path with its shadow ray.
constexpr double kSegmentSeconds = 0.4e-6;
/// Part of the paths that goes on after each bounce.
constexpr double kSurvival = 0.8;

Duration duration_of(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

double path_segments(int bounces) { return (1.0 - std::pow(kSurvival, bounces + 1)) / (1.0 - kSurvival); }

bool may(const node::BlockOrder& /*order*/) { return true; }

}  // namespace

double cell_seconds(const wire::View& view, int column, int row) {
  const double content =
      1.0 + 0.5 * std::sin(0.21 * column + view.eye_m().x()) * std::cos(0.17 * row + view.eye_m().z());
  const double paths = 256.0 * view.samples() * content;
  return paths * path_segments(static_cast<int>(view.bounces())) * kSegmentSeconds;
}

std::shared_ptr<const node::BlockOrder> SimulatedNode::next() const { return queue_.next(may); }

SimulatedNode::Work& SimulatedNode::work_of(const std::shared_ptr<const node::BlockOrder>& order, TimePoint now) {
  const auto [found, is_new] = begun_.try_emplace(order.get());
  Work& work = found->second;
  if (!is_new) return work;
  const wire::RenderBlock& block = order->block;
  work.order = order;
  work.came_at = now;
  const PixelRect rect = node::rect_of(block);
  work.tiles = balance::tiles_of(rect);
  const PixelRect all = cells_touched(rect);
  work.cells.resize(static_cast<std::size_t>(all.area()));
  for (int row = all.y; row < all.y + all.height; ++row) {
    for (int column = all.x; column < all.x + all.width; ++column) {
      work.cells[cell_index(all, column, row)] = static_cast<float>(cell_seconds(block.view(), column, row));
    }
  }
  for (const PixelRect& tile : work.tiles) {
    const PixelRect cells = cells_touched(tile);
    double seconds = 0.0;
    for (int row = cells.y; row < cells.y + cells.height; ++row) {
      for (int column = cells.x; column < cells.x + cells.width; ++column) {
        seconds += static_cast<double>(work.cells[cell_index(all, column, row)]);
      }
    }
    work.tile_seconds.push_back(seconds / speed_);
  }
  for (float& seconds : work.cells) seconds /= static_cast<float>(speed_);
  render::RenderQuality quality;
  quality.samples = static_cast<int>(block.view().samples());
  quality.bounces = static_cast<int>(block.view().bounces());
  const int piece = std::min(quality.samples, render::max_samples_per_piece(quality));
  wire::View one = block.view();
  one.set_samples(static_cast<std::uint32_t>(piece));
  work.cell = 1.5 * cell_seconds(one, 0, 0) / speed_;
  return work;
}

void SimulatedNode::take(const wire::NodeCommand& command, TimePoint now) {
  if (command.has_render()) {
    auto order = std::make_shared<node::BlockOrder>();
    order->link = 1;
    order->block = command.render();
    CHECK(queue_.add(std::move(order)));
  } else if (command.has_cancel()) {
    queue_.cancel(1, command.cancel().block());
  } else {
    return;
  }
  if (at_work_ == nullptr) return begin_piece(now);
  if (next() != at_work_ || at_work_->cancelled)
    ends_at_ = std::min(*ends_at_, now + duration_of(begun_.at(at_work_.get()).cell));
}

void SimulatedNode::begin_piece(TimePoint now) {
  at_work_ = next();
  began_at_ = now;
  ends_at_.reset();
  if (at_work_ == nullptr) return;
  Work& work = work_of(at_work_, now);
  if (at_work_->cancelled) {
    ends_at_ = now;
    return;
  }
  const double ahead = queue_.seconds_ahead(*at_work_, may) / threads_;
  const double limit = std::min(kMaxPieceSeconds, std::max(ahead, kMinPieceSeconds)) + work.cell;
  ends_at_ = now + duration_of(std::min(work.tile_seconds[work.next] / threads_, limit)) + Duration(1);
}

std::vector<wire::NodeReport> SimulatedNode::end_piece(TimePoint now) {
  std::vector<wire::NodeReport> reports;
  Work& work = begun_.at(at_work_.get());
  const std::uint64_t number = at_work_->block.block();
  const double done = std::min(to_seconds(now - began_at_) * threads_, work.tile_seconds[work.next]);
  work.tile_seconds[work.next] -= done;
  work.spent += done;
  busy_seconds_ += done;
  queue_.serve(1, number, done);
  if (!at_work_->cancelled && work.tile_seconds[work.next] <= 1e-7) {
    wire::BlockTile& sent = *reports.emplace_back().mutable_tile();
    sent.set_block(number);
    const PixelRect& rect = work.tiles[work.next++];
    wire::Tile& tile = *sent.mutable_tile();
    tile.set_view_number(at_work_->block.view().number());
    tile.set_x_px(static_cast<std::uint32_t>(rect.x));
    tile.set_y_px(static_cast<std::uint32_t>(rect.y));
    tile.set_width_px(static_cast<std::uint32_t>(rect.width));
    tile.set_height_px(static_cast<std::uint32_t>(rect.height));
    tile.set_jpeg("jpeg");
    work.reported = work.spent;
  } else if (work.spent - work.reported >= kProgressSeconds) {
    work.reported = work.spent;
    wire::BlockProgress& progress = *reports.emplace_back().mutable_progress();
    progress.set_block(number);
    progress.set_render_cpu_seconds(work.spent);
  }
  if (at_work_->cancelled) {
    end_block(work, "cancelled", now, &reports);
  } else if (work.next == work.tiles.size()) {
    end_block(work, "", now, &reports);
  }
  begin_piece(now);
  return reports;
}

void SimulatedNode::end_block(const Work& work, const std::string& error, TimePoint now,
                              std::vector<wire::NodeReport>* reports) {
  const std::uint64_t number = work.order->block.block();
  wire::BlockEnd& end = *reports->emplace_back().mutable_end();
  end.set_block(number);
  end.set_error(error);
  end.set_render_cpu_seconds(work.spent);
  end.set_wall_seconds(work.spent / threads_);
  end.set_waited_seconds(std::max(0.0, to_seconds(now - work.came_at) - work.spent / threads_));
  if (error.empty()) *end.mutable_cell_cpu_seconds() = {work.cells.begin(), work.cells.end()};
  queue_.remove(1, number);
  begun_.erase(work.order.get());
}

}  // namespace cyclorama
