// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/frame_planner.h"

#include <algorithm>
#include <array>
#include <set>

#include "renderfarm/coordinator/block_orders.h"

namespace cyclorama::coordinator {
namespace {

/// Overhead of one more node in seconds, until its orders are written; measured as the fan-out of `./bench.sh
/// farm-overhead`. The node's tiles arrive while other nodes render.
constexpr double kNodeSeconds = 0.00005;
/// Minimum cost in cpu-seconds, so that a frame without a measured cost still takes its turn.
constexpr double kMinCpuSeconds = 1e-4;

balance::PictureSize size_of(const wire::View& view) {
  return {static_cast<int>(view.panorama().width_px()), static_cast<int>(view.panorama().height_px())};
}

std::array<double, 3> eye_of(const wire::View& view) { return {view.eye_m().x(), view.eye_m().y(), view.eye_m().z()}; }

/// Returns the azimuth span in radians; 0 for a picture that a change of heading does not shift.
double shifting_span(const wire::View& view) {
  return view.panorama().projection() == wire::Panorama::CYLINDER ? view.panorama().azimuth_span_rad() : 0.0;
}

/// Returns the number of pictures, one above another: one per eye.
int stacked(const wire::View& view) { return view.panorama().has_eyes() ? 2 : 1; }

/// Returns the relative cost of a pixel, which grows with its samples; the extra cost of a bounce depends on the scene.
double effort_of(const wire::View& view) { return view.samples(); }

}  // namespace

std::vector<AssignedBlock> FramePlanner::split(SessionId id, Session& session, const wire::View& view,
                                               bool whole_blocks) {
  std::vector<NodeId> nodes = nodes_.able(session.scene, session.account, view.light());
  placement_.arrange(id, &nodes);
  std::vector<double> speeds;
  std::vector<double> thread_speeds;
  for (const NodeId at : nodes) {
    const Node& node = nodes_.at(at);
    speeds.push_back(speeds_.of(node, session.scene) * placement_.free_part(id, at));
    thread_speeds.push_back(node.scenes.at(session.scene).speed);
  }
  balance::SplitRequest request{size_of(view), speeds, view.heading_rad(), shifting_span(view)};
  request.eye_m = eye_of(view);
  request.effort = effort_of(view);
  request.stacked = stacked(view);
  request.block_overhead_seconds = BlockOrders::kOverheadSeconds;
  request.node_overhead_seconds = kNodeSeconds;
  request.whole_blocks = whole_blocks;
  std::vector<AssignedBlock> blocks;
  for (const balance::PlannedBlock& block : session.balancer->split(request)) {
    blocks.push_back(
        {nodes[block.node], block.rect, {block.predicted_seconds, thread_speeds[block.node], block.stealable}});
  }
  return blocks;
}

void FramePlanner::take_turn(const Session& session, FrameInFlight* frame) {
  const bool at_rest = frame->refines.has_value();
  const Accounts::Demand demand{at_rest, at_rest ? session.refinement_cpu_seconds : session.frame_cpu_seconds,
                                1e-6 * static_cast<double>(frame->asked_px)};
  frame->turn = accounts_.begin(session.account, demand, clock_.now());
}

void FramePlanner::place(SessionId id, const Session& session, const std::vector<AssignedBlock>& blocks) {
  if (!session.costs_known) return;
  std::vector<Placement::NodeWork> works;
  works.reserve(blocks.size());
  for (const AssignedBlock& block : blocks) {
    works.push_back({block.node, block.forecast.seconds / speeds_.of(nodes_.at(block.node), session.scene)});
  }
  placement_.planned(id, works, clock_.now());
}

double FramePlanner::threads_of(const std::vector<AssignedBlock>& blocks) const {
  std::set<NodeId> nodes;
  for (const AssignedBlock& block : blocks) nodes.insert(block.node);
  return nodes_.threads_of(nodes);
}

void FramePlanner::finish(Session& session, const FrameInFlight& frame, const FrameReport& report) {
  accounts_.end(session.account, frame.turn);
  // Blocks of a frame that was given up are charged when they end, which is later than this.
  double& predicted = frame.refines ? session.refinement_cpu_seconds : session.frame_cpu_seconds;
  const double cost = frame.failure ? std::max(frame.charged_seconds, predicted) : frame.charged_seconds;
  predicted = std::max(cost, kMinCpuSeconds);
  if (frame.refines || report.costs.empty()) return;
  session.costs_known = true;
  session.balancer->learn({size_of(frame.view), report.costs, frame.view.heading_rad(), eye_of(frame.view),
                           effort_of(frame.view), stacked(frame.view)});
}

}  // namespace cyclorama::coordinator
