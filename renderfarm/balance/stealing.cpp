// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/stealing.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::balance {
namespace {

constexpr double kMinSpeed = 1e-9;

double usable(double value) { return std::isfinite(value) ? std::max(value, 0.0) : 0.0; }
double usable_speed(double speed) { return std::max(usable(speed), kMinSpeed); }

/// Returns the elapsed time of the first block over its predicted time; 1 while it is on time.
double lateness(const NodeQueue& node) {
  if (node.blocks.empty()) return 1.0;
  const double predicted = usable(node.blocks.front().work) / usable_speed(node.speed);
  // A block without a predicted cost gives no information about its node.
  return predicted > 0.0 ? std::max(1.0, usable(node.elapsed_seconds) / predicted) : 1.0;
}

double seconds_of(const QueuedBlock& block, const NodeQueue& node) {
  return usable(block.work) / usable_speed(node.speed);
}

/// Returns the predicted remaining time of the block being rendered.
double first_seconds(const NodeQueue& node) {
  return node.blocks.empty() ? 0.0
                             : std::max(0.0, seconds_of(node.blocks.front(), node) - usable(node.elapsed_seconds));
}

}  // namespace

double NodeQueue::remaining_seconds() const {
  double rest = 0.0;
  for (std::size_t i = 1; i < blocks.size(); ++i) rest += seconds_of(blocks[i], *this);
  return first_seconds(*this) + rest * lateness(*this);
}

std::optional<Steal> choose_steal(std::span<const NodeQueue> nodes, std::size_t idle, double overhead_seconds) {
  if (idle >= nodes.size()) return std::nullopt;
  const double overhead = usable(overhead_seconds);
  std::optional<Steal> best;
  double max = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const NodeQueue& victim = nodes[i];
    if (i == idle || victim.blocks.size() < 2) continue;
    const double remaining = victim.remaining_seconds();
    if (remaining <= max) continue;
    const double late = lateness(victim);
    double begins = first_seconds(victim);
    double gain = 0.0;
    for (std::size_t b = 1; b < victim.blocks.size(); ++b) {
      const double there = seconds_of(victim.blocks[b], victim) * late;
      const double here = overhead + seconds_of(victim.blocks[b], nodes[idle]);
      const double gained = std::min(there, remaining - here);
      if (victim.blocks[b].stealable && begins >= overhead && gained > 0.0 && gained >= gain) {
        gain = gained;
        max = remaining;
        best = Steal{i, b};
      }
      begins += there;
    }
  }
  return best;
}

}  // namespace cyclorama::balance
