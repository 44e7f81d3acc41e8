// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/deadlines.h"

#include <algorithm>
#include <limits>

namespace cyclorama::coordinator {
namespace {

/// A node is silent after the longest of three times. The first is this fraction of its session's base time.
constexpr double kSilent = 0.6;
/// The second is this multiple of the time that its block was expected to take.
constexpr double kExpected = 1.5;
/// The third is a lower bound, because the system may just have been busy for a moment.
constexpr Duration kMinSilenceTimeout = std::chrono::milliseconds(10);
/// A picture at rest has no budget: its timeout is this multiple of the other nodes' slowest block.
constexpr double kAtRest = 4.0;
/// Minimum of that timeout.
constexpr Duration kMinAtRestTimeout = std::chrono::milliseconds(500);
/// After this multiple of the base time, a frame is given up for the next one.
constexpr double kLate = 2.0;

Duration duration_of(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

/// Returns the base time in seconds.
double base_seconds(const Session& session) {
  const double budget = session.governed ? 1e-3 * session.governed->governor.budget_ms() : 0.0;
  return std::max(budget, session.pace_seconds);
}

TimePoint late_at(const Session& session, const FrameInFlight& frame) {
  return frame.foremost_since + duration_of(kLate * base_seconds(session));
}

}  // namespace

void Deadlines::for_each_due(const Session& session, const FrameInFlight& frame,
                             const std::function<void(NodeId, const Node&, TimePoint)>& visit) const {
  const double at_rest = frame.refines ? kAtRest * frame.assembly.summary().render_seconds : 0.0;
  const Duration silence = std::max(kMinSilenceTimeout, duration_of(kSilent * base_seconds(session)));
  for (const auto& [id, blocks] : frame.assembly.outstanding()) {
    const auto node = nodes_.find(id);
    if (node == nodes_.end()) continue;
    if (frame.refines) {
      const TimePoint since = std::max(node->second.worked_at, frame.planned_at);
      visit(id, node->second, since + std::max(kMinAtRestTimeout, duration_of(at_rest)));
      continue;
    }
    double forecast = 0.0;
    if (session.costs_known) {
      forecast = std::numeric_limits<double>::infinity();
      for (const std::uint64_t block : blocks) {
        forecast = std::min(forecast, frame.assembly.blocks().at(block).forecast.seconds);
      }
      forecast /= speeds_.wall_speed_of(node->second, session.scene);
    }
    const TimePoint since = std::max(node->second.worked_at, frame.foremost_since);
    visit(id, node->second, since + std::max(silence, duration_of(kExpected * forecast)));
  }
}

DueTimes Deadlines::due(const Session& session) const {
  DueTimes due{TimePoint::max(), TimePoint::max()};
  if (session.frames.empty()) return due;
  const TimePoint now = clock_.now();
  const FrameInFlight& frame = session.frames.front();
  const auto consider = [&](TimePoint at) {
    due.earliest = std::min(due.earliest, at);
    if (at > now) due.next = std::min(due.next, at);
  };
  for_each_due(session, frame, [&](NodeId, const Node&, TimePoint at) { consider(at); });
  if (frame.begun && !frame.refines) consider(late_at(session, frame));
  return due;
}

bool Deadlines::is_late(const Session& session, const FrameInFlight& frame) const {
  return !frame.refines && clock_.now() >= late_at(session, frame);
}

bool Deadlines::has_idle_node(const Session& session, const FrameInFlight& frame) const {
  return std::ranges::any_of(nodes_.able(session.scene, session.account, frame.view.light()), [&](NodeId node) {
    return !nodes_.at(node).is_late(session.account) && !frame.assembly.waits_for(node);
  });
}

std::vector<NodeId> Deadlines::silent_nodes(const Session& session, const FrameInFlight& frame) const {
  std::vector<NodeId> silent;
  const TimePoint now = clock_.now();
  for_each_due(session, frame, [&](NodeId id, const Node& node, TimePoint at) {
    if (now >= at && !node.is_late(session.account)) silent.push_back(id);
  });
  if (silent.empty() || !has_idle_node(session, frame)) return {};
  return silent;
}

}  // namespace cyclorama::coordinator
