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

/// What became of one frame, for the operator.
struct FrameReport {
  SessionId session{};
  std::string museum{};
  bool complete = false;
  std::string reason{};
  bool refined = false;        ///< A picture at rest, again with more samples: its times are not those of a moving one.
  int samples = 0;             ///< Per pixel, in all.
  double scale = 1.0;          ///< Rendered over asked width.
  double budget_ms = 0.0;      ///< 0: the view said its quality itself.
  bool late = false;           ///< Given up at the deadline.
  bool reassigned = false;     ///< Others made what a node owed.
  int moved = 0;               ///< Blocks that went to a node that was done.
  TimePoint received_at{};     ///< The view.
  double queue_seconds = 0.0;  ///< From then until its turn came: older frames of the session were at work.
  double plan_seconds = 0.0;   ///< Until it was split and the nodes' orders were made.
  double fan_out_seconds = 0.0;  ///< Until the last of these orders was written to its node.
  double rays_seconds =
      0.0;  ///< The longest that a block was away at its node, waiting for other rays or tracing its own.
  double render_seconds = 0.0;
  double encode_seconds = 0.0;
  double farm_seconds = 0.0;
  std::vector<double> loads{};  ///< Cpu-seconds per thread, by node.
  std::vector<NodeId> nodes{};  ///< Whose loads these are.
  double balance_efficiency = 1.0;
  double cpu_seconds = 0.0;
  std::uint64_t rays = 0;
  std::size_t bytes = 0;
  wire::View view{};                            ///< As rendered.
  std::vector<balance::MeasuredBlock> costs{};  ///< Of all its blocks; empty when some were given again.
};

/// Whom a sentence for the log is about; what is empty is not said.
struct NoticeAbout {
  std::string node{};
  std::string museum{};
  SessionId session{};
  bool is_trouble = false;  ///< Somebody may have to do something.
};

/// What CoordinatorState can do to the world. Every call returns at once; nothing calls back into CoordinatorState. Thread-bound.
class CoordinatorDelegate {
 public:
  virtual ~CoordinatorDelegate() = default;
  virtual void to_node(NodeId node, const wire::NodeCommand& command) = 0;
  /// Queued in order; CoordinatorState::written() must follow for each, unless the session ends first.
  virtual void to_museum(SessionId session, wire::SessionReply reply) = 0;
  /// The stream is cut; no event of that node may follow, not even node_disconnected().
  virtual void end_node(NodeId node, const Error& reason) = 0;
  /// What is queued goes out first, when `at_once` is false; no event of that session may follow.
  virtual void end_session(SessionId session, const Error& reason, bool at_once) = 0;
  virtual void frame_ended(const FrameReport& report) = 0;
  /// A sentence for the log: a node came, a scene failed to load.
  virtual void notice(const std::string& sentence, const NoticeAbout& about) = 0;

 protected:
  CoordinatorDelegate() = default;
  CoordinatorDelegate(const CoordinatorDelegate&) = default;
  CoordinatorDelegate& operator=(const CoordinatorDelegate&) = default;
};

}  // namespace cyclorama::coordinator
