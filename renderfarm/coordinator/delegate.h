// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/error.h"
#include "common/wire/farm.pb.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/balance/work_grid.h"
#include "renderfarm/coordinator/ids.h"

namespace cyclorama::coordinator {

/// The outcome of one frame, for the operator.
struct FrameReport {
  SessionId session{};
  std::string museum{};
  bool complete = false;
  std::string reason{};
  /// True for a refinement of a picture at rest; its times cannot be compared with those of a moving picture.
  bool refined = false;
  int samples = 0;               ///< Samples per pixel, in total.
  double scale = 1.0;            ///< Rendered width over requested width.
  double budget_ms = 0.0;        ///< 0: the view itself specified its quality.
  bool late = false;             ///< True if it was given up at its deadline.
  bool reassigned = false;       ///< True if tiles of one node were reassigned to others.
  int moved = 0;                 ///< Number of blocks that an idle node took over.
  TimePoint received_at{};       ///< Arrival of the view.
  double queue_seconds = 0.0;    ///< Time that the view waited behind older frames of the session.
  double plan_seconds = 0.0;     ///< Time to split the frame and build the commands to the nodes.
  double fan_out_seconds = 0.0;  ///< Time until the last of these commands was written.
  /// Longest time that a block was at its node, including its wait for other blocks.
  double rays_seconds = 0.0;
  double render_seconds = 0.0;
  double encode_seconds = 0.0;
  double farm_seconds = 0.0;
  std::vector<double> loads{};  ///< Cpu-seconds per thread, one entry per node.
  std::vector<NodeId> nodes{};  ///< The nodes of `loads`, in the same order.
  double balance_efficiency = 1.0;
  double cpu_seconds = 0.0;
  std::uint64_t rays = 0;
  std::size_t bytes = 0;
  wire::View view{};                            ///< The view as rendered.
  std::vector<balance::MeasuredBlock> costs{};  ///< Costs of all blocks; empty if blocks were reassigned.
};

/// The subject of a sentence for the log; empty fields are omitted.
struct NoticeAbout {
  std::string node{};
  std::string museum{};
  SessionId session{};
  bool is_trouble = false;  ///< True if the operator may have to act.
};

/// The commands and events that CoordinatorState emits. Every function returns at once and never calls
/// CoordinatorState. Thread-bound.
class CoordinatorDelegate {
 public:
  virtual ~CoordinatorDelegate() = default;
  virtual void to_node(NodeId node, const wire::NodeCommand& command) = 0;
  /// Queues a message in order. CoordinatorState::written() must follow for each, unless the session ends first.
  virtual void to_museum(SessionId session, wire::SessionReply reply) = 0;
  /// Accepts this light, or a piece of it, from a node: CoordinatorState::light_stored() must follow once it is
  /// complete.
  virtual void accept_light(const wire::LightVersion& light) = 0;
  /// No node needs the file of this light or piece any more.
  virtual void forget_light(const wire::LightVersion& light) = 0;
  /// The stream is cut; no event of that node may follow, not even node_disconnected().
  virtual void end_node(NodeId node, const Error& reason) = 0;
  /// Ends the session; if `at_once` is false, its queued messages are sent first. No event of the session may follow.
  virtual void end_session(SessionId session, const Error& reason, bool at_once) = 0;
  virtual void frame_ended(const FrameReport& report) = 0;
  /// Logs a sentence, for example that a node connected or a scene failed to load.
  virtual void notice(const std::string& sentence, const NoticeAbout& about) = 0;

 protected:
  CoordinatorDelegate() = default;
  CoordinatorDelegate(const CoordinatorDelegate&) = default;
  CoordinatorDelegate& operator=(const CoordinatorDelegate&) = default;
};

}  // namespace cyclorama::coordinator
