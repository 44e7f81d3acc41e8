// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "renderfarm/node/block_work.h"
#include "renderfarm/node/film_store.h"
#include "renderfarm/node/node_link.h"
#include "renderfarm/node/render_queue.h"
#include "renderfarm/node/scene_store.h"

namespace cyclorama::node {

/// Renders the blocks of all coordinators piece by piece; RenderQueue chooses the block of each piece. Orders come from
/// any thread. The caller of wait() and work(), always the same thread, renders. Keeps a reference to the scenes, which
/// must outlive it.
class RenderWorker {
 public:
  RenderWorker(SceneStore& scenes, std::size_t max_film_bytes) : scenes_(scenes), films_(max_film_bytes) {}

  // Thread-safe:

  void open(std::shared_ptr<NodeLink> link);
  /// Abandons all blocks of the link and forgets its sessions.
  void drop(LinkId link);
  /// Queues a block. If its scene is not loaded when rendering begins, the block ends with an error. Errors: kBadData
  /// if the coordinator violates the protocol: a number in use, too many blocks, or a huge message.
  Status take(LinkId link, const wire::RenderBlock& block);
  /// Cancels a block: its end is sent soon, even if the block is waiting or half rendered.
  void cancel(LinkId link, std::uint64_t block);
  void forget_session(const FilmStore::Session& session);
  /// To be called when a link may be able to accept tiles again.
  void link_moved();
  [[nodiscard]] std::size_t waiting() const;
  /// Waits until no block has waited for the duration `quiet`. Returns false at the deadline.
  bool wait_until_idle(TimePoint deadline, Duration quiet);
  /// Returns false if a block is being rendered and none of its cells was begun since `since`. Used by the watchdog.
  [[nodiscard]] bool has_moved_since(TimePoint since) const;
  /// Ends wait(), and the current piece within one cell.
  void stop();

  // For the render thread only:

  /// Waits for work. Returns false once stopped.
  bool wait();
  /// Does one piece of work: at most a tile, or a block's end. The piece ends at the next cell when a block arrives
  /// that precedes it, or when its account has received as much service as another account that waits. Returns false if
  /// there is no block.
  bool work();

 private:
  [[nodiscard]] std::shared_ptr<const BlockOrder> next() const;
  void look_again();
  /// Returns a function that checks whether a link accepts tiles. Precondition: the mutex is held.
  [[nodiscard]] RenderQueue::TakesTiles takes_tiles() const;
  /// Sets `ends_at_` to the time when a block of another account precedes the current one. Precondition: the mutex is
  /// held.
  void limit_piece();
  /// Returns the seconds spent on rendering since the start, including the current piece.
  [[nodiscard]] double rendered_seconds() const;
  std::shared_ptr<const BlockOrder> begin_piece();
  /// Records the end of a piece and its thread time.
  void end_piece(double cpu_seconds);
  /// Does the next piece of a block. Returns its thread time.
  double advance(const std::shared_ptr<const BlockOrder>& order);
  /// Renders a piece of a block that is not cancelled. Returns its thread time. May throw std::bad_alloc.
  double render_piece(const std::shared_ptr<const BlockOrder>& order);
  void end_block(const BlockOrder& order, std::string error);
  void send(LinkId link, NodeLink::Outgoing item);

  SceneStore& scenes_;
  FilmStore films_;                               ///< Render thread only.
  std::map<const BlockOrder*, BlockWork> begun_;  ///< Render thread only. The orders are in `queue_`.
  std::atomic<bool> preempted_ = false;           ///< True if another block precedes the current one.
  std::atomic<Duration::rep> ends_at_{0};         ///< End of the current piece, as the count of a TimePoint.
  std::atomic<bool> rendering_ = false;
  std::atomic<Duration::rep> moved_at_{0};  ///< Time of the last begun cell, as the count of a TimePoint.

  mutable std::mutex mutex_;  ///< Guards the following.
  mutable std::condition_variable changed_;
  std::atomic<bool> stopping_ = false;  ///< Also read without the mutex by the render threads.
  RenderQueue queue_;
  std::map<LinkId, std::shared_ptr<NodeLink>> links_;
  std::shared_ptr<const BlockOrder> at_work_;
  TimePoint piece_began_at_{};                      ///< Start of the current piece.
  double rendered_seconds_ = 0.0;                   ///< Total of the earlier pieces.
  double parallelism_ = 1.0;                        ///< Thread time over wall time of recent pieces.
  std::vector<FilmStore::Session> ended_sessions_;  ///< Sessions to be forgotten.
  std::vector<LinkId> dropped_;                     ///< Links to be forgotten.
};

}  // namespace cyclorama::node
