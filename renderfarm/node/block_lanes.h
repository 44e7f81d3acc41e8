// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/base/clock.h"
#include "renderfarm/node/render_queue.h"

namespace cyclorama::node {

/// Returns how many blocks a node of so many threads has in work at once. Threads that find no cell of the first block,
/// because it is between two steps or nearly done, compute cells of the others (render/cell_queue.h). Each takes memory
/// for a picture. Chosen by `./bench.sh node-threads`.
[[nodiscard]] std::size_t lanes_for(int threads);

/// Decides which blocks of a RenderQueue are in work, one in each lane, in which order they get threads, and when a
/// piece of work ends:
///
///   - a free lane begins the first block that no lane has in work;
///   - when all lanes are in use and a block arrives that precedes the last of them, that one gives way;
///   - a piece ends when its account has received as much service as another that waits, after 5 ms or more.
///
/// With one lane, one block is in work at a time. Pure; thread-bound.
class BlockLanes {
 public:
  /// One piece of work on one block.
  struct Lane {
    std::shared_ptr<const BlockOrder> order{};  ///< Null: the lane is free.
    std::size_t place = 0;  ///< Order among the lanes in use; the first gets all threads it can use.
    bool is_preempted = false;
    TimePoint began_at{};
    TimePoint ends_at{};
  };

  explicit BlockLanes(std::size_t lanes) : lanes_(lanes) {}

  RenderQueue& queue() { return queue_; }
  [[nodiscard]] const RenderQueue& queue() const { return queue_; }
  [[nodiscard]] const std::vector<Lane>& lanes() const { return lanes_; }
  /// Returns the block that a free lane would begin; null if there is none. A block that fails `may` waits, unless it
  /// was cancelled.
  [[nodiscard]] std::shared_ptr<const BlockOrder> next(const RenderQueue::May& may) const;
  /// Begins a piece in a free lane. Returns null, and leaves the lane free, if there is no block.
  std::shared_ptr<const BlockOrder> begin(std::size_t lane, TimePoint now, const RenderQueue::May& may);
  /// Ends a lane's piece, which took so much thread time.
  void end(std::size_t lane, TimePoint now, double cpu_seconds);
  /// To be called when anything changed in the queue or in what `may` be rendered. Sets the lanes' places, ends and who
  /// gives way.
  void update(const RenderQueue::May& may);
  [[nodiscard]] bool is_in_work(const BlockOrder& order) const;

 private:
  RenderQueue queue_;
  std::vector<Lane> lanes_;
  double parallelism_ = 1.0;  ///< Thread time over wall time of recent pieces that had the first place.
};

}  // namespace cyclorama::node
