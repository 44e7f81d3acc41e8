// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/simulation.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <queue>
#include <utility>

#include "renderfarm/balance/stealing.h"
#include "renderfarm/balance/work_sums.h"

namespace cyclorama {
namespace {

enum class Event { kBlockEnds, kStealArrives };

struct Happening {
  double at = 0.0;
  std::size_t node = 0;
  Event event = Event::kBlockEnds;
  /// At equal times the lower node comes first, so that the order does not depend on the queue.
  friend bool operator>(const Happening& a, const Happening& b) { return a.at != b.at ? a.at > b.at : a.node > b.node; }
};

struct Node {
  std::vector<std::size_t> blocks;  ///< From the plan; the first is being rendered if `busy`.
  bool busy = false;
  double begun_at = 0.0;
  struct Promise {
    std::size_t from = 0;
    std::size_t block = 0;
  };
  std::optional<Promise> promised;  ///< A block that is on its way to this node.
};

class Simulation {
 public:
  Simulation(const SimulatedFarm& farm, const balance::WorkGrid& work, std::span<const balance::PlannedBlock> plan)
      : farm_(farm), sums_(work), work_(work), plan_(plan), nodes_(farm.speeds.size()), promised_(plan.size(), false) {
    for (std::size_t i = 0; i < plan.size(); ++i) nodes_[plan[i].node].blocks.push_back(i);
  }

  SimulatedFrame run() {
    double ordered_at = 0.0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].blocks.empty()) continue;
      ordered_at += farm_.node_overhead_seconds;
      begin(i, ordered_at);
    }
    if (farm_.stealing) let_idle_steal(0.0);
    while (!happenings_.empty()) {
      const Happening now = happenings_.top();
      happenings_.pop();
      if (now.event == Event::kBlockEnds) {
        end_block(now.node, now.at);
      } else {
        arrive(now.node, now.at);
      }
      if (farm_.stealing) let_idle_steal(now.at);
    }
    return std::move(frame_);
  }

 private:
  void begin(std::size_t i, double at) {
    Node& node = nodes_[i];
    node.busy = true;
    node.begun_at = at;
    const PixelRect& rect = plan_[node.blocks.front()].rect;
    const double seconds = farm_.block_overhead_seconds + sums_.of(balance::cells_of(rect)) / farm_.speeds[i];
    happenings_.push({at + seconds, i, Event::kBlockEnds});
  }

  void end_block(std::size_t i, double at) {
    Node& node = nodes_[i];
    measure(i, plan_[node.blocks.front()].rect);
    node.blocks.erase(node.blocks.begin());
    node.busy = false;
    frame_.seconds = std::max(frame_.seconds, at);
    if (!node.blocks.empty()) begin(i, at);
  }

  /// Handles the arrival of a stolen block at the thief.
  void arrive(std::size_t i, double at) {
    const Node::Promise promise = *std::exchange(nodes_[i].promised, std::nullopt);
    promised_[promise.block] = false;
    Node& victim = nodes_[promise.from];
    const auto found = std::ranges::find(victim.blocks, promise.block);
    if (found == victim.blocks.end() || (victim.busy && found == victim.blocks.begin())) {
      ++frame_.late_steals;
      return;
    }
    victim.blocks.erase(found);
    ++frame_.steals;
    nodes_[i].blocks.push_back(promise.block);
    begin(i, at);
  }

  void let_idle_steal(double now) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].busy || nodes_[i].promised) continue;
      // Only the idle node's own speed varies, so queues that refused a node of at least this speed refuse this one
      // too.
      if (refused_at_ == now && refused_by_ >= farm_.speeds[i] && !changed_) continue;
      const std::optional<balance::Steal> steal =
          balance::choose_steal(queues(now), i, farm_.steal_seconds + farm_.block_overhead_seconds);
      if (!steal) {
        refused_at_ = now;
        refused_by_ = farm_.speeds[i];
        changed_ = false;
        continue;
      }
      const std::size_t block = shown_[steal->from][steal->block];
      nodes_[i].promised = Node::Promise{steal->from, block};
      promised_[block] = true;
      changed_ = true;
      happenings_.push({now + farm_.steal_seconds, i, Event::kStealArrives});
    }
    changed_ = true;
  }

  std::span<const balance::NodeQueue> queues(double now) {
    queues_.resize(nodes_.size());
    shown_.resize(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Node& node = nodes_[i];
      balance::NodeQueue& queue = queues_[i];
      queue.speed = farm_.speeds[i];
      queue.blocks.clear();
      shown_[i].clear();
      queue.elapsed_seconds = node.busy ? now - node.begun_at : 0.0;
      for (const std::size_t block : node.blocks) {
        if (promised_[block]) continue;
        queue.blocks.push_back({plan_[block].predicted_seconds, plan_[block].stealable});
        shown_[i].push_back(block);
      }
    }
    return queues_;
  }

  void measure(std::size_t i, const PixelRect& rect) {
    balance::MeasuredBlock block{rect, 0.0, {}, farm_.speeds[i]};
    const balance::CellRect cells = balance::cells_of(rect);
    for (int y = cells.y; y < cells.y + cells.height; ++y) {
      for (int x = cells.x; x < cells.x + cells.width; ++x) {
        block.cell_cpu_seconds.push_back(static_cast<float>(work_.at(x, y) / farm_.speeds[i]));
      }
    }
    block.cpu_seconds = sums_.of(cells) / farm_.speeds[i];
    frame_.measured.push_back(std::move(block));
  }

  const SimulatedFarm& farm_;
  const balance::WorkSums sums_;
  const balance::WorkGrid& work_;
  std::span<const balance::PlannedBlock> plan_;
  std::vector<Node> nodes_;
  std::vector<bool> promised_;  ///< For each block: it is on its way to a thief.
  std::priority_queue<Happening, std::vector<Happening>, std::greater<>> happenings_;
  std::vector<balance::NodeQueue> queues_;
  std::vector<std::vector<std::size_t>> shown_;  ///< The blocks behind each of queues_.
  double refused_at_ = -1.0;
  double refused_by_ = 0.0;
  bool changed_ = true;
  SimulatedFrame frame_;
};

}  // namespace

double SimulatedFrame::efficiency(std::span<const double> speeds) const {
  double work = 0.0;
  double speed = 0.0;
  for (const balance::MeasuredBlock& block : measured) work += block.cpu_seconds * block.speed;
  for (const double s : speeds) speed += s;
  return seconds > 0.0 ? work / (speed * seconds) : 1.0;
}

SimulatedFrame simulate(const SimulatedFarm& farm, const balance::WorkGrid& work,
                        std::span<const balance::PlannedBlock> plan) {
  return Simulation(farm, work, plan).run();
}

}  // namespace cyclorama
