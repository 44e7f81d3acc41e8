// SPDX-License-Identifier: Apache-2.0
/// Plain data of CoordinatorState: the records of nodes and of museums' sessions.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/clock.h"
#include "common/base/frame_window.h"
#include "common/wire/farm.pb.h"
#include "common/wire/light_versions.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/balance/balancer.h"
#include "renderfarm/coordinator/accounts.h"
#include "renderfarm/coordinator/frame_assembly.h"
#include "renderfarm/coordinator/governed.h"
#include "renderfarm/coordinator/ids.h"
#include "renderfarm/trust/grants.h"

namespace cyclorama::coordinator {

struct ReceivedView {
  wire::View view;
  TimePoint received_at{};
};

struct FrameInFlight {
  std::uint64_t id = 0;  ///< Distinguishes the first frame of a view from its refinements.
  wire::View view;       ///< The view as rendered.
  FrameAssembly assembly{};
  TimePoint received_at{};    ///< Arrival of the view.
  TimePoint turn_began_at{};  ///< Time when planning began.
  TimePoint planned_at{};
  TimePoint fanned_out_at{};       ///< Time when the last command of the plan was written.
  std::uint64_t last_planned = 0;  ///< Number of the plan's last block; higher ones were reassigned or moved.
  /// Time when it became the oldest frame of its session; its deadlines are counted from then.
  TimePoint foremost_since{};
  TimePoint last_tile_at{};
  bool begun = false;              ///< True once its `begin` was sent; its tiles are then relayed as they arrive.
  std::vector<wire::Tile> held{};  ///< Tiles that arrived while an older frame was open.
  std::size_t bytes = 0;           ///< Bytes of all its tiles.
  std::optional<std::string> failure{};
  bool late = false;  ///< True if it failed only because of the deadline.
  int moved = 0;      ///< Number of blocks that an idle node took over.
  Accounts::Turn turn{};
  double charged_seconds = 0.0;                    ///< Cpu-seconds of its ended blocks.
  double threads = 0.0;                            ///< Sum of the threads of all nodes that got blocks of its plan.
  std::int64_t asked_px = 0;                       ///< Pixels of the requested panorama, before any scaling.
  double work = 0.0;                               ///< See MeasuredFrame::work; 0 unless the session is governed.
  std::optional<governor::SampleRange> refines{};  ///< Range of samples that it adds to a picture at rest.

  [[nodiscard]] bool is_over() const { return failure || assembly.is_complete(); }
};

/// A frame that is over and whose end has not been written yet.
struct WrittenFrame {
  std::uint64_t view_number = 0;
  TimePoint planned_at{};
  TimePoint last_tile_at{};
  bool reassigned = false;
  double work = 0.0;        ///< See FrameInFlight::work.
  double rays_ms = 0.0;     ///< See MeasuredFrame::rays_ms; 0 if parts of the frame were not rendered as planned.
  double megapixels = 0.0;  ///< Requested size, before any scaling.
  int samples_added = 0;    ///< Samples per pixel that a refinement added; 0 for other frames.
};

/// Deadlines of a session's oldest frame.
struct DueTimes {
  /// The earliest of all, also if it has passed. A lower bound: nodes that work move it. min(): to be computed again.
  TimePoint earliest = TimePoint::min();
  TimePoint next = TimePoint::max();  ///< The earliest that has not passed.
};

struct Session {
  trust::Grant grant{};  ///< Permissions of the session.
  std::string museum{};
  std::string scene{};  ///< Empty until the session is opened.
  TimePoint arrived_at{};
  std::uint64_t newest_view = 0;
  /// Counts the frames of `frames` and `unwritten_ends` as in flight, so a view waits until an older frame is written.
  FrameWindow<ReceivedView> views{};
  /// Oldest first; tiles of the first frame are relayed to the museum. A refinement is never in flight with another
  /// frame.
  std::deque<FrameInFlight> frames{};
  std::deque<WrittenFrame> unwritten_ends{};
  std::size_t bytes_waiting = 0;  ///< Bytes of held tiles and of tiles that the museum has not taken yet.
  std::size_t messages_waiting = 0;
  TimePoint taken_at{};  ///< Time when the museum last took a message.
  std::unique_ptr<balance::Balancer> balancer{};
  std::unique_ptr<GovernorState> governed{};  ///< Null: each view specifies its quality.
  AccountId account{};
  bool costs_known = false;  ///< True once a frame was measured, so that forecasts have a basis.
  /// Charges of the last moving frame and of the last refinement; each predicts the charge of the next one of its kind.
  double frame_cpu_seconds = 0.05;
  double refinement_cpu_seconds = 0.05;
  double pace_seconds = 0.5;                  ///< Recent frame time: a maximum that decays slowly.
  DueTimes due{};                             ///< Deadlines of the oldest frame.
  std::uint64_t watermark = 0;                ///< See wire::RenderBlock::watermark.

  static constexpr double kMaxPaceSeconds = 60.0;
  /// Updates the pace with the time of a frame, counted from when it became the oldest frame of the session.
  void learn_pace(double seconds) {
    constexpr double kNew = 0.1;
    pace_seconds = std::min(kMaxPaceSeconds, std::max(seconds, (1.0 - kNew) * pace_seconds + kNew * seconds));
  }
  /// Doubles the pace after a missed deadline, so that too short deadlines do not starve the session.
  void miss_pace() { pace_seconds = std::min(kMaxPaceSeconds, 2.0 * pace_seconds); }
};

struct BlockLocation {
  SessionId session{};
  std::uint64_t frame = 0;
  AccountId account{};  ///< Account that is charged for the block, even after the session or the frame has ended.
  WorkClass work = WorkClass::kMoving;
  double charged_seconds = 0.0;  ///< Cpu-seconds charged so far.
};

struct Node {
  enum class SceneState { kLoading, kLoaded, kFailed, kDropped };
  struct LoadedScene {
    SceneState state = SceneState::kLoading;
    std::string error{};
    std::uint64_t memory_bytes = 0;  ///< Size that the node reported.
    /// Speed of one of the node's threads in this scene, relative to the threads of the first node.
    double speed = 1.0;
    TimePoint asked_at{};                    ///< Time of the order to load the scene.
    std::deque<wire::LightVersion> light{};  ///< Versions of the scene's light that the node has, newest first.
    bool can_compute_light = false;
    bool has_failed_to_compute = false;  ///< True if it failed to compute light; it gets no further order.
    bool has_failed_to_use = false;      ///< True if it could not fetch or use the current light.
    std::string offered_light{};         ///< Version that the node was last ordered to use.
    TimePoint light_offered_at{};        ///< Time of that order.
  };
  std::string name{};
  double threads = 0.0;  ///< 0 until hello.
  TimePoint arrived_at{};
  TimePoint worked_at{};  ///< Time when it last sent a tile, ended a block, or received one while it had none.
  /// Accounts whose frames the node delayed, if it has been silent since then. With a single account, the cause may be
  /// that the account requested more than any node could render in time.
  std::set<AccountId> late_for{};
  std::optional<TimePoint> late_logged_at{};  ///< Time of the last log line about its lateness.
  int late_unlogged = 0;                      ///< Number of unlogged repetitions since then.
  double utilisation = 1.0;                   ///< Recent utilisation of its threads by its blocks.
  double used_seconds = 0.0;                  ///< Thread time of its blocks, decayed.
  double possible_seconds = 0.0;              ///< Wall time of its blocks times its threads, decayed.
  TimePoint measured_at{};                    ///< Time of the last measurement or estimate.
  wire::NodeStatus status{};                  ///< Latest status report.
  std::map<std::string, LoadedScene> scenes{};
  /// An account's blocks of one class here.
  struct WaitingAccount {
    std::size_t blocks = 0;
    double stated = 0.0;  ///< Service of the account last stated to the node, in virtual time.
  };
  std::map<std::pair<AccountId, WorkClass>, WaitingAccount> accounts{};  ///< Those of `blocks`.
  std::map<std::uint64_t, BlockLocation> blocks{};  ///< Assigned and not yet ended, whether or not still wanted.

  /// Returns true if the node gets no new blocks of the account while other nodes do.
  [[nodiscard]] bool is_late(AccountId account) const { return late_for.size() > 1 || late_for.contains(account); }
  [[nodiscard]] bool has(const std::string& scene) const {
    const auto found = scenes.find(scene);
    return found != scenes.end() && found->second.state == SceneState::kLoaded;
  }
  [[nodiscard]] bool has_light(const std::string& scene, const std::string& version) const;
};

/// Returns "node 'NAME'", for messages.
[[nodiscard]] std::string title_of(const Node& node);

/// Returns the first digits of a light's version, for messages.
[[nodiscard]] std::string short_version(const std::string& version);

}  // namespace cyclorama::coordinator
