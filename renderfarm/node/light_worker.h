// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/base/clock.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/node/light_computation.h"
#include "renderfarm/node/light_files.h"

namespace cyclorama::node {

/// Computes the light of scenes ahead, one after another, while no block waits.
///
///   want() ──► waiting ──► computing ◄──► paused ──► finished()
///                             │  give_way() ▲ no block for kQuiet
///                             └─────────────┘
///
/// The coordinator decides which pieces of the light this node computes, and whether a scene whose light could not be
/// computed is tried again.
class LightWorker {
 public:
  struct Calls {
    std::function<bool()> has_blocks;  ///< Returns true while the node has blocks; called from any thread.
    /// Returns false if the scene at `path` was unloaded or replaced; the computation of its light is then aborted.
    std::function<bool(const std::string& path)> is_wanted;
    /// The computation for the scene at `path` has begun a stage or has further pieces. The message names no scene.
    /// Called by the thread of work().
    std::function<void(const std::string& path, const wire::LightPieces& pieces)> progressed;
    /// The light of the scene at `path` is in `file`, or it failed. Called by the thread of work().
    std::function<void(const std::string& path, const std::filesystem::path& file, const Status& status)> finished;
  };
  /// Idle time before a paused computation resumes, so that it does not start and stop between the frames of a visit.
  static constexpr Duration kQuiet = std::chrono::seconds(2);

  /// Without a starter, nothing is computed. `clock` must outlive this object.
  LightWorker(LightStarter starter, LightFiles files, Calls calls, const Clock& clock);

  // Thread-safe:

  /// Requests the light of a scene; does nothing if it was requested already. `name` is the coordinator's name for the
  /// scene.
  void want(const std::string& path, const std::string& name);
  /// The light has come from elsewhere: it is not computed to the end.
  void forget(const std::string& path);
  /// Orders pieces; without effect unless the computation for the scene at `path` is at that stage.
  void compute(const std::string& path, const wire::ComputePieces& order);
  /// Returns the current stage for the scene at `path` with all pieces that are here; nothing if there is none. The
  /// message names no scene.
  [[nodiscard]] std::optional<wire::LightPieces> stage_of(const std::string& path) const;
  /// Returns where the file of a piece is or belongs; empty unless the current computation for the scene at `path` has
  /// reached that stage.
  [[nodiscard]] std::filesystem::path piece_file(const std::string& path, const wire::LightStage& stage,
                                                 std::uint32_t piece) const;
  /// The file of a piece has come.
  void fetched(const std::string& path, const wire::LightStage& stage, std::uint32_t piece);
  /// To be called when a block arrives: pauses at once.
  void give_way();
  /// Adds an entry for each scene whose light is requested and not yet computed.
  void report(wire::NodeStatus* status) const;
  /// Ends wait(). The current computation is ended when work() is next called, or by the destructor.
  void stop();

  // For the light thread only:

  /// Waits until light is requested, then for kPeriod while a computation runs. Returns false once stopped.
  bool wait();
  /// Starts, resumes or ends a computation as needed. Returns false if no light is requested.
  bool work();

 private:
  struct Wanted {
    std::string path;
    std::string name;
    bool is_forgotten = false;
  };
  struct Stage {
    BegunStage begun;
    std::map<std::uint32_t, wire::LightVersion> taken{};  ///< Files by piece.
  };
  /// Returns null unless the current computation is that of the scene at `path` and has reached the stage. To be called
  /// under mutex_.
  [[nodiscard]] const Stage* find_stage(const std::string& path, const wire::LightStage& stage) const;
  static void set_stage(const BegunStage& stage, wire::LightStage* to);
  /// Notes what the computation has reported, and passes it on.
  void follow(const std::string& path, const std::vector<LightEvent>& events);
  void end_current();  ///< Under mutex_.
  void begin(const Wanted& wanted);
  [[nodiscard]] bool is_quiet() const;

  const LightStarter starter_;
  const LightFiles files_;
  const Calls calls_;
  const Clock& clock_;
  std::filesystem::path file_;  ///< File of the current computation. Light thread only.

  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  std::deque<Wanted> waiting_;  ///< The first is the current one, if there is a computation.
  std::shared_ptr<LightComputation> current_;
  std::map<std::uint32_t, Stage> stages_;  ///< Those that the current computation has reached, by number.
  bool paused_ = false;
  TimePoint block_at_ = TimePoint::min();  ///< Time when a block last arrived or waited.
  double done_share_ = 0.0;
  double worked_seconds_ = 0.0;  ///< Time that the current computation has run.
  TimePoint looked_at_{};
};

}  // namespace cyclorama::node
