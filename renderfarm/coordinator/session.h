// SPDX-License-Identifier: Apache-2.0
/// What the coordinator remembers of a node and of a museum's session: plain data of CoordinatorState.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/frame_window.h"
#include "common/wire/farm.pb.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/balance/balancer.h"
#include "renderfarm/coordinator/fair_share.h"
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
  std::uint64_t id = 0;  ///< Frames of one view, the first and its refinements, differ in it.
  wire::View view;       ///< As rendered.
  FrameAssembly assembly{};
  TimePoint received_at{};    ///< The view.
  TimePoint turn_began_at{};  ///< Its planning began.
  TimePoint planned_at{};
  TimePoint fanned_out_at{};       ///< The last order of the plan was written to its node.
  std::uint64_t last_planned = 0;  ///< The plan's last block; those beyond were given again, or moved.
  TimePoint
      foremost_since{};  ///< When no older frame of its session was before it any more: its deadlines count from here.
  TimePoint last_tile_at{};
  bool begun = false;              ///< Its `begin` was sent: tiles go out as they come.
  std::vector<wire::Tile> held{};  ///< Tiles that came while an older frame was open.
  std::size_t bytes = 0;           ///< Of all its tiles.
  std::optional<std::string> failure{};
  bool late = false;  ///< It failed by the deadline alone.
  int moved = 0;      ///< Blocks that went to a node that was done.
  double fair_start = 0.0;
  std::int64_t asked_px = 0;                       ///< Of the panorama as asked for, whatever the scale.
  std::size_t point = 0;                           ///< Of the session's front, if it is governed.
  std::optional<governor::SampleRange> refines{};  ///< The samples that it adds to a picture at rest.

  [[nodiscard]] bool is_over() const { return failure || assembly.is_complete(); }
};

/// A frame whose end is not yet on the wire.
struct WrittenFrame {
  std::uint64_t view_number = 0;
  TimePoint planned_at{};
  TimePoint last_tile_at{};
  bool reassigned = false;
  std::size_t point = 0;
  double megapixels = 0.0;  ///< As asked for, whatever its scale.
  int samples_added = 0;    ///< By a refinement; else 0.
};

struct Session {
  trust::Grant grant{};  ///< What it may do.
  std::string museum{};
  std::string scene{};  ///< Empty until the session is opened.
  TimePoint arrived_at{};
  std::uint64_t newest_view = 0;
  /// In flight: the numbers of `frames` and `unwritten_ends`, so that a frame starts when an older one is on the wire.
  FrameWindow<ReceivedView> views{};
  std::deque<FrameInFlight> frames{};  ///< Oldest first; the museum gets the front one. A refinement is alone.
  std::deque<WrittenFrame> unwritten_ends{};
  std::size_t bytes_waiting = 0;  ///< Held tiles, and tiles that the museum has not taken yet.
  std::size_t messages_waiting = 0;
  TimePoint taken_at{};  ///< When the museum last took something.
  std::unique_ptr<balance::Balancer> balancer{};
  std::unique_ptr<GovernorState> governed{};  ///< Null: each view says its own quality.
  FairShare::Flow share{};
  bool costs_known = false;                   ///< A frame was measured: forecasts are no guesses.
  double frame_cpu_seconds = 0.05;            ///< What its last frame cost: what the next one will.
  double pace_seconds = kInitialPaceSeconds;  ///< What a frame takes: the most of the last few.
  TimePoint next_due = TimePoint::max();      ///< When a deadline of the foremost frame is met or missed.
  std::uint64_t watermark = 0;                ///< As wire::RenderBlock.

  static constexpr double kInitialPaceSeconds = 0.5;
  static constexpr double kMaxPaceSeconds = 60.0;
  /// A frame took so long, since it was at the front.
  void learn_pace(double seconds) {
    constexpr double kNew = 0.1;
    pace_seconds = std::min(kMaxPaceSeconds, std::max(seconds, (1.0 - kNew) * pace_seconds + kNew * seconds));
  }
  /// No session starves of deadlines that nobody can keep: after each missed one the next is later.
  void miss_pace() { pace_seconds = std::min(kMaxPaceSeconds, 2.0 * pace_seconds); }
};

struct BlockLocation {
  SessionId session{};
  std::uint64_t frame = 0;
};

struct Node {
  enum class SceneState { kLoading, kLoaded, kFailed, kDropped };
  struct LoadedScene {
    SceneState state = SceneState::kLoading;
    std::string error{};
    double speed = 1.0;    ///< Of one of the node's threads in this scene: 1 is the first node's that told.
    TimePoint asked_at{};  ///< When it was told to load it.
  };
  std::string name{};
  double threads = 0.0;  ///< 0 until hello.
  TimePoint arrived_at{};
  TimePoint worked_at{};  ///< When it last sent a tile or ended a block, or was given one while it had none.
  bool late = false;  ///< It kept a frame waiting, and has said nothing since: it gets no new blocks while others do.
  std::optional<TimePoint> late_logged_at{};  ///< When the log last said so.
  int late_unlogged = 0;                      ///< How often it did not, since then.
  double utilisation = 1.0;                   ///< Of its threads by its blocks, of the last few.
  double used_seconds = 0.0;                  ///< By them; older ones count less.
  double possible_seconds = 0.0;              ///< Wall time of all threads meanwhile.
  TimePoint measured_at{};                    ///< When the utilisation was last seen, or guessed.
  wire::NodeStatus status{};                  ///< The last it told.
  std::map<std::string, LoadedScene> scenes{};
  std::map<std::uint64_t, BlockLocation> blocks{};  ///< Ordered and not yet ended, whether or not still wanted.

  [[nodiscard]] bool has(const std::string& scene) const {
    const auto found = scenes.find(scene);
    return found != scenes.end() && found->second.state == SceneState::kLoaded;
  }
};

}  // namespace cyclorama::coordinator
