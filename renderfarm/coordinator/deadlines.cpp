// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/deadlines.h"

#include <algorithm>
#include <set>

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

TimePoint Deadlines::due_at(const Session& session, const FrameInFlight& frame,
                            const FrameAssembly::Block& block) const {
  const auto node = nodes_.find(block.node);
  if (node == nodes_.end()) return TimePoint::max();
  const TimePoint since = std::max(node->second.worked_at, frame.refines ? frame.planned_at : frame.foremost_since);
  if (frame.refines) {
    return since + std::max(kMinAtRestTimeout, duration_of(kAtRest * frame.assembly.summary().render_seconds));
  }
  const double expected =
      session.costs_known ? block.forecast.seconds / speeds_.wall_speed_of(node->second, session.scene) : 0.0;
  return since + std::max({kMinSilenceTimeout, duration_of(kExpected * expected),
                           duration_of(kSilent * base_seconds(session))});
}

TimePoint Deadlines::next_due(const Session& session) const {
  TimePoint next = TimePoint::max();
  if (session.frames.empty()) return next;
  const TimePoint now = clock_.now();
  const FrameInFlight& frame = session.frames.front();
  const auto consider = [&](TimePoint at) { next = at > now ? std::min(next, at) : next; };
  for (const auto& [number, block] : frame.assembly.blocks()) {
    if (block.is_outstanding()) consider(due_at(session, frame, block));
  }
  if (frame.begun && !frame.refines) consider(late_at(session, frame));
  return next;
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
  std::set<NodeId> silent;
  if (!has_idle_node(session, frame)) return {};
  for (const auto& [number, block] : frame.assembly.blocks()) {
    const auto node = nodes_.find(block.node);
    if (node == nodes_.end() || node->second.is_late(session.account) || !block.is_outstanding()) continue;
    if (clock_.now() >= due_at(session, frame, block)) silent.insert(block.node);
  }
  return {silent.begin(), silent.end()};
}

}  // namespace cyclorama::coordinator
