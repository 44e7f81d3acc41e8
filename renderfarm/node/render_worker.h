// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "renderfarm/node/block_work.h"
#include "renderfarm/node/film_store.h"
#include "renderfarm/node/node_link.h"
#include "renderfarm/node/render_queue.h"
#include "renderfarm/node/scene_store.h"

namespace cyclorama::node {

/// The blocks of all coordinators, and the work at them: one piece after another, each of the block that goes first. Orders
/// come from any thread; the work is done by whoever calls wait() and work(), always the same thread.
/// Keeps a reference to the scenes, which must outlive it.
class RenderWorker {
 public:
  RenderWorker(SceneStore& scenes, std::size_t max_film_bytes) : scenes_(scenes), films_(max_film_bytes) {}

  // Thread-safe:

  void open(std::shared_ptr<NodeLink> link);
  /// All blocks of the link are given up, and its sessions forgotten.
  void drop(LinkId link);
  /// The scene must be loaded by now. kBadData  the coordinator is broken: a number in use, too many blocks, a huge message.
  Status take(LinkId link, const wire::RenderBlock& block);
  /// The block's end comes soon, whether it waits or is half done.
  void cancel(LinkId link, std::uint64_t block);
  void forget_session(const FilmStore::Session& session);
  /// To be called when a link may take tiles again.
  void link_moved();
  [[nodiscard]] std::size_t waiting() const;
  /// True once nothing has waited for `quiet`; false at the deadline.
  bool wait_until_idle(TimePoint deadline, Duration quiet);
  /// False when a block is at work and no cell of it was begun since `since`: for the watchdog.
  [[nodiscard]] bool has_moved_since(TimePoint since) const;
  /// Ends wait(), and the piece at hand within a cell.
  void stop();

  // The render thread's:

  /// Waits for work; false once stopped.
  bool wait();
  /// Does one piece of work: at most a tile, or a block's end. False when there is none.
  bool work();

 private:
  [[nodiscard]] std::shared_ptr<const BlockOrder> next() const;
  void look_again();
  /// Since the start, the piece at hand included.
  [[nodiscard]] double rendered_seconds() const;
  std::shared_ptr<const BlockOrder> begin_piece();
  void end_piece();
  void advance(const std::shared_ptr<const BlockOrder>& order);
  void end_block(const BlockOrder& order, std::string error);
  void send(LinkId link, NodeLink::Outgoing item);

  SceneStore& scenes_;
  FilmStore films_;                               ///< The render thread's.
  std::map<const BlockOrder*, BlockWork> begun_;  ///< Likewise. Their orders are in the queue.
  std::atomic<bool> preempted_ = false;           ///< Another block than the one at work goes first.
  std::atomic<bool> rendering_ = false;
  std::atomic<Duration::rep> moved_at_{0};  ///< TimePoint's count: when a cell was last begun.

  mutable std::mutex mutex_;  ///< Guards the following.
  mutable std::condition_variable changed_;
  std::atomic<bool> stopping_ = false;  ///< Read without it from the render threads.
  RenderQueue queue_;
  std::map<LinkId, std::shared_ptr<NodeLink>> links_;
  std::shared_ptr<const BlockOrder> at_work_;
  TimePoint piece_began_at_{};                      ///< Of what is at work.
  double rendered_seconds_ = 0.0;                   ///< By the pieces before it.
  std::vector<FilmStore::Session> ended_sessions_;  ///< Sessions to be forgotten.
  std::vector<LinkId> dropped_;                     ///< Links to be forgotten.
};

}  // namespace cyclorama::node
