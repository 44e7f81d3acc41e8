// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
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
/// If a computation fails, the coordinator decides whether to try again.
class LightWorker {
 public:
  struct Calls {
    std::function<bool()> has_blocks;  ///< Returns true while the node has blocks; called from any thread.
    /// Returns false if the scene at `path` was unloaded or replaced; the computation of its light is then aborted.
    std::function<bool(const std::string& path)> is_wanted;
    /// Called when the light of the scene at `path` is complete in `file` or has failed, by the thread that calls
    /// work().
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
  /// Pauses the computation at once. To be called when a block arrives.
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
  };
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
  bool paused_ = false;
  TimePoint block_at_ = TimePoint::min();  ///< Time when a block last arrived or waited.
  double done_share_ = 0.0;
  double worked_seconds_ = 0.0;  ///< Time that the current computation has run.
  TimePoint looked_at_{};
};

}  // namespace cyclorama::node
