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
#include "renderfarm/node/block_lanes.h"
#include "renderfarm/node/block_work.h"
#include "renderfarm/node/film_store.h"
#include "renderfarm/node/node_link.h"
#include "renderfarm/node/scene_store.h"
#include "renderfarm/render/crew.h"

namespace cyclorama::node {

/// Renders the blocks of all coordinators piece by piece; BlockLanes chooses the block of each piece. Orders come from
/// any thread. A thread for each lane calls wait() and work(); the crew, whose threads the renderers use, too, computes
/// the cells of all lanes. Keeps a reference to the scenes, which must outlive it.
class RenderWorker {
 public:
  RenderWorker(SceneStore& scenes, std::size_t max_film_bytes, std::shared_ptr<render::Crew> crew);

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

  /// Returns the number of lanes, lanes_for() the crew.
  [[nodiscard]] std::size_t lanes() const { return running_.size(); }
  /// The threads that compute pictures, for work on finished tiles.
  [[nodiscard]] render::Crew& crew() { return *crew_; }

  // For the lanes' threads only:

  /// Waits for work. Returns false once stopped.
  bool wait();
  /// Does one piece of work in a lane, which no other thread uses meanwhile: at most a tile, or a block's end. The piece ends at the next cell when a block arrives
  /// that precedes it, or when its account has received as much service as another account that waits. Returns false if
  /// there is no block.
  bool work(std::size_t lane = 0);

 private:
  /// The state that the crew's threads check while a lane's piece is rendered.
  struct Running {
    std::atomic<bool> is_preempted = false;
    std::atomic<Duration::rep> ends_at{0};         ///< End of the piece, as the count of a TimePoint.
    std::optional<render::Crew::Picture> picture;  ///< Guarded by the mutex; made and used by the lane's thread.
  };
  struct Begun {
    BlockWork work;
    /// Wall time of the pieces, each without the share in which the crew computed other lanes' cells.
    double wall_seconds = 0.0;
  };

  // Precondition of the next four: the mutex is held.
  [[nodiscard]] std::shared_ptr<const BlockOrder> next() const;
  void look_again();
  /// Returns a function that checks whether a block's link accepts tiles.
  [[nodiscard]] RenderQueue::May takes_tiles() const;
  /// Returns the seconds in which blocks were rendered since the start, including current pieces.
  [[nodiscard]] double rendered_seconds() const;

  std::shared_ptr<const BlockOrder> begin_piece(std::size_t lane);
  /// Records the end of a piece and its thread time.
  void end_piece(std::size_t lane, double cpu_seconds);
  /// Does the next piece of a block. Returns its thread time.
  double advance(std::size_t lane, const std::shared_ptr<const BlockOrder>& order);
  /// Renders a piece of a block that is not cancelled. Returns its thread time. May throw std::bad_alloc.
  double render_piece(std::size_t lane, const std::shared_ptr<const BlockOrder>& order);
  /// Returns the work on a block, which stays until its end; null if it cannot begin, when its end is sent.
  Begun* begun_of(const std::shared_ptr<const BlockOrder>& order);
  void end_block(const BlockOrder& order, std::string error);
  void send(LinkId link, NodeLink::Outgoing item);

  SceneStore& scenes_;
  FilmStore films_;
  const std::shared_ptr<render::Crew> crew_;
  std::vector<std::unique_ptr<Running>> running_;  ///< Indexed by lane.
  std::atomic<int> rendering_ = 0;                 ///< Lanes whose piece is being rendered.
  std::atomic<Duration::rep> moved_at_{0};         ///< Time of the last begun cell, as the count of a TimePoint.

  mutable std::mutex mutex_;  ///< Guards the following.
  mutable std::condition_variable changed_;
  std::atomic<bool> stopping_ = false;  ///< Also read without the mutex by the render threads.
  BlockLanes lanes_;
  /// Blocks that are begun; each is used by the lane that has it in work. Those of dropped links leave when no lane has.
  std::map<const BlockOrder*, Begun> begun_;
  std::map<LinkId, std::shared_ptr<NodeLink>> links_;
  std::size_t busy_lanes_ = 0;
  TimePoint busy_since_{};
  double rendered_seconds_ = 0.0;                   ///< Total of the earlier times in which a lane was busy.
  std::vector<FilmStore::Session> ended_sessions_;  ///< Sessions to be forgotten.
  std::vector<LinkId> dropped_;                     ///< Links to be forgotten.
};

}  // namespace cyclorama::node
