// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/placement.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::coordinator {
namespace {

/// Amount by which a node that a session uses counts as freer, so that the session leaves only for a clearly better
/// one.
constexpr double kStay = 0.15;
/// Weight of the latest time between two frames in the smoothed time.
constexpr double kNew = 0.2;

}  // namespace

double Placement::load(NodeId node) const {
  const auto found = loads_.find(node);
  return found == loads_.end() ? 0.0 : std::max(0.0, found->second);
}

double Placement::load_of_others(const Place& place, NodeId node) const {
  const auto own = place.loads.find(node);
  return std::max(0.0, load(node) - (own == place.loads.end() ? 0.0 : own->second));
}

void Placement::arrange(SessionId session, std::vector<NodeId>* nodes) {
  Place& place = places_[session];
  std::vector<NodeId> fresh;
  for (const NodeId node : *nodes) {
    if (!place.order.contains(node)) fresh.push_back(node);
  }
  std::ranges::stable_sort(fresh, {}, [&](NodeId node) { return load_of_others(place, node); });
  for (const NodeId node : fresh) place.order.emplace(node, place.next_position++);
  std::ranges::sort(*nodes, {}, [&](NodeId node) { return place.order.at(node); });
}

double Placement::free_part(SessionId session, NodeId node) const {
  const auto found = places_.find(session);
  const bool is_used = found != places_.end() && found->second.loads.contains(node);
  const double others = found == places_.end() ? load(node) : load_of_others(found->second, node);
  const double free = 1.0 - others + (is_used ? kStay : 0.0);
  return std::clamp(std::floor(free / kStep) * kStep, kStep, 1.0);
}

void Placement::planned(SessionId session, std::span<const NodeWork> works, TimePoint now) {
  Place& place = places_[session];
  const double elapsed = to_seconds(now - place.planned_at);
  if (place.loads.empty()) {
    place.seconds_per_frame = 1.0;
  } else {
    place.seconds_per_frame += kNew * (std::min(elapsed, 1.0) - place.seconds_per_frame);
  }
  clear(&place);
  place.planned_at = now;
  for (const NodeWork& work : works) {
    const double load = std::clamp(work.seconds / std::max(place.seconds_per_frame, 1e-3), 0.0, 1.0);
    const double sum = place.loads[work.node] + load;
    place.loads[work.node] = std::min(1.0, sum);
  }
  for (const auto& [node, load] : place.loads) loads_[node] += load;
}

void Placement::clear(Place* place) {
  for (const auto& [node, load] : place->loads) {
    const auto total = loads_.find(node);
    if (total != loads_.end()) total->second -= load;
  }
  place->loads.clear();
}

void Placement::expire(TimePoint now) {
  for (auto& [session, place] : places_) {
    if (now - place.planned_at > kExpiry) clear(&place);
  }
}

void Placement::forget(SessionId session) {
  const auto found = places_.find(session);
  if (found == places_.end()) return;
  clear(&found->second);
  places_.erase(found);
}

void Placement::forget(NodeId node) {
  loads_.erase(node);
  for (auto& [session, place] : places_) {
    place.loads.erase(node);
    place.order.erase(node);
  }
}

}  // namespace cyclorama::coordinator
