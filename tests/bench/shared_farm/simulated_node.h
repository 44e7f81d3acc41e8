// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/clock.h"
#include "common/image/pixel_rect.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/node/render_queue.h"

namespace cyclorama {

/// Cost of a cell of 16x16 pixels in thread-seconds: what a path tracer takes for its samples and bounces, in content
/// that differs from place to place.
[[nodiscard]] double cell_seconds(const wire::View& view, int column, int row);

/// A node whose blocks are served by the real RenderQueue, and whose rays only take simulated time. Thread-bound.
///
/// It works like a RenderWorker with one lane: on one block at a time, in pieces that end at a tile's end, when another account has
/// waited long enough, or at the next cell after an order that goes first has come.
class SimulatedNode {
 public:
  SimulatedNode(int threads, double speed) : threads_(threads), speed_(speed) {}

  void take(const wire::NodeCommand& command, TimePoint now);
  /// Returns when the current piece ends; nothing if there is no work.
  [[nodiscard]] std::optional<TimePoint> piece_ends_at() const { return ends_at_; }
  /// Ends the current piece and begins the next. Returns what the node reports. Precondition: piece_ends_at() is `now`.
  std::vector<wire::NodeReport> end_piece(TimePoint now);

  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] double speed() const { return speed_; }
  /// Thread-seconds that it worked.
  [[nodiscard]] double busy_seconds() const { return busy_seconds_; }

 private:
  struct Work {
    std::shared_ptr<const node::BlockOrder> order;
    std::vector<PixelRect> tiles;
    std::vector<double> tile_seconds;  ///< Thread time that each still needs.
    std::vector<float> cells;
    std::size_t next = 0;
    double spent = 0.0;
    double reported = 0.0;
    double cell = 0.0;  ///< Thread time until it can be interrupted.
    TimePoint came_at{};
  };
  void begin_piece(TimePoint now);
  [[nodiscard]] std::shared_ptr<const node::BlockOrder> next() const;
  Work& work_of(const std::shared_ptr<const node::BlockOrder>& order, TimePoint now);
  void end_block(const Work& work, const std::string& error, TimePoint now, std::vector<wire::NodeReport>* reports);

  const int threads_;
  const double speed_;
  node::RenderQueue queue_;
  std::map<const node::BlockOrder*, Work> begun_;
  std::shared_ptr<const node::BlockOrder> at_work_;
  TimePoint began_at_{};
  std::optional<TimePoint> ends_at_;
  double busy_seconds_ = 0.0;
};

}  // namespace cyclorama
