// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/node_threads/simulated_threads.h"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>

#include "renderfarm/node/block_lanes.h"
#include "renderfarm/render/cell_queue.h"

namespace cyclorama {
namespace {

constexpr double kWarmUpSeconds = 1.0;
constexpr node::LinkId kLink = 1;

class Simulation {
 public:
  Simulation(const std::vector<BlockTrace>& blocks, int threads, std::size_t lanes, int visits)
      : blocks_(blocks), threads_(threads), lanes_(lanes), cells_(threads), runs_(lanes) {
    idle_workers_ = threads - 1;
    received_us_.resize(static_cast<std::size_t>(visits));
    for (int round = 0; round < 2; ++round) {
      for (int visit = 0; visit < visits; ++visit) order(visit);
    }
  }

  ThreadsUse run(double seconds) {
    const double end = kWarmUpSeconds + seconds;
    dispatch();
    while (!events_.empty() && events_.top().at < end) {
      const Event event = events_.top();
      events_.pop();
      now_ = event.at;
      happen(event);
      dispatch();
    }
    std::ranges::sort(frame_seconds_);
    const auto percentile = [&](double share) {
      if (frame_seconds_.empty()) return 0.0;
      return 1e3 * frame_seconds_[static_cast<std::size_t>(share * static_cast<double>(frame_seconds_.size() - 1))];
    };
    return {busy_seconds_ / (threads_ * seconds), static_cast<double>(frame_seconds_.size()) / seconds, percentile(0.5),
            percentile(0.99)};
  }

 private:
  /// Cells that the crew computes for a lane or for the send thread.
  struct Step {
    std::vector<float> cells{};
    int taken = 0;
    bool own_thread_works = false;
  };
  struct Progress {
    const BlockTrace* trace = nullptr;
    double began = 0.0;
    std::size_t step = 0;
    std::vector<float> left{};  ///< Cells of an interrupted step.
  };
  struct Run {
    std::shared_ptr<const node::BlockOrder> order{};
    render::CellQueue::Lane lane = 0;
    double cpu_seconds = 0.0;
  };
  struct Event {
    double at = 0.0;
    std::optional<render::CellQueue::Cells> cells{};  ///< Computed now; empty: a lane's own thread is done.
    bool by_own_thread = false;
    std::size_t run = 0;
    friend bool operator<(const Event& a, const Event& b) { return a.at > b.at; }
  };

  [[nodiscard]] TimePoint time() const {
    return TimePoint(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(now_)));
  }
  [[nodiscard]] node::RenderQueue::May may() const {
    const bool takes = waiting_tiles_.size() < static_cast<std::size_t>(std::max(4, threads_ / 2));
    return [takes](const node::BlockOrder&) { return takes; };
  }

  void order(int visit) {
    auto made = std::make_shared<node::BlockOrder>();
    made->link = kLink;
    made->block.set_block(++ordered_);
    made->block.set_account(static_cast<std::uint64_t>(visit) + 1);
    made->block.set_rank(static_cast<std::uint64_t>(received_us_[static_cast<std::size_t>(visit)]));
    progress_[made.get()] = {&blocks_[ordered_ % blocks_.size()], now_, 0, {}};
    lanes_.queue().add(std::move(made));
    update();
  }

  void update() {
    lanes_.update(may());
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (runs_[i].order != nullptr) cells_.set_order(runs_[i].lane, lanes_.lanes()[i].place + 1);
    }
  }

  void use(double seconds) {
    if (now_ > kWarmUpSeconds) busy_seconds_ += seconds;
  }

  void start(double seconds, Event event) {
    event.at = now_ + seconds;
    use(seconds);
    events_.push(event);
  }

  /// Gives work to every thread that has none.
  void dispatch() {
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (runs_[i].order == nullptr) begin_piece(i);
    }
    if (!sending_ && !waiting_tiles_.empty()) begin_encoding();
    for (auto& [lane, step] : steps_) {
      if (step.own_thread_works) continue;
      if (const auto cells = cells_.take(lane)) {
        step.own_thread_works = true;
        compute(*cells, true, lane);
      }
    }
    while (idle_workers_ > 0) {
      const auto cells = cells_.take();
      if (!cells) break;
      --idle_workers_;
      compute(*cells, false, 0);
    }
  }

  void compute(const render::CellQueue::Cells& cells, bool by_own_thread, std::size_t lane) {
    Step& step = steps_.at(cells.lane);
    step.taken = cells.end;
    const double seconds = std::accumulate(step.cells.begin() + cells.first, step.cells.begin() + cells.end, 0.0);
    start(seconds, {.cells = cells, .by_own_thread = by_own_thread, .run = lane});
  }

  void begin_piece(std::size_t i) {
    Run& run = runs_[i];
    run.order = lanes_.begin(i, time(), may());
    if (run.order == nullptr) return;
    run.lane = cells_.open(lanes_.lanes()[i].place + 1);
    run.cpu_seconds = 0.0;
    update();
    go_on(i);
  }

  /// Begins what the block's own thread does before the next step, or the step's remaining cells.
  void go_on(std::size_t i) {
    Run& run = runs_[i];
    Progress& progress = progress_.at(run.order.get());
    if (!progress.left.empty()) return begin_step(run.lane, std::exchange(progress.left, {}));
    const bool is_last = progress.step == progress.trace->rendering.size();
    const double seconds =
        is_last ? progress.trace->rest_seconds : progress.trace->rendering[progress.step].serial_seconds;
    run.cpu_seconds += seconds;
    start(seconds, {.run = i});
  }

  void begin_step(render::CellQueue::Lane lane, std::vector<float> cells) {
    cells_.begin(lane, static_cast<int>(cells.size()));
    steps_[lane] = {std::move(cells)};
  }

  void happen(const Event& event) {
    if (!event.cells) return own_thread_done(event.run);
    const auto lane = event.cells->lane;
    if (event.by_own_thread) {
      if (const auto own = steps_.find(event.run); own != steps_.end()) own->second.own_thread_works = false;
    } else {
      ++idle_workers_;
    }
    Step& step = steps_.at(lane);
    const double seconds =
        std::accumulate(step.cells.begin() + event.cells->first, step.cells.begin() + event.cells->end, 0.0);
    const auto run = std::ranges::find_if(runs_, [&](const Run& r) { return r.order != nullptr && r.lane == lane; });
    if (run != runs_.end()) {
      run->cpu_seconds += seconds;
      const node::BlockLanes::Lane& state = lanes_.lanes()[static_cast<std::size_t>(run - runs_.begin())];
      if (state.is_preempted || time() >= state.ends_at) cells_.drop_rest(lane);
    }
    if (!cells_.finish(*event.cells, seconds)) return;
    const Step done = std::move(steps_.extract(lane).mapped());
    if (run == runs_.end()) return encoded();
    Progress& progress = progress_.at(run->order.get());
    progress.left.assign(done.cells.begin() + done.taken, done.cells.end());
    const auto i = static_cast<std::size_t>(run - runs_.begin());
    if (!progress.left.empty()) return end_piece(i);
    ++progress.step;
    go_on(i);
  }

  void own_thread_done(std::size_t i) {
    Run& run = runs_[i];
    Progress& progress = progress_.at(run.order.get());
    if (progress.step < progress.trace->rendering.size()) {
      return begin_step(run.lane, progress.trace->rendering[progress.step].cells);
    }
    for (const float seconds : progress.trace->encoding) waiting_tiles_.push_back({seconds, run.order->block.block()});
    unsent_[run.order->block.block()] = {progress.trace->encoding.size(), progress.began,
                                         static_cast<int>(run.order->block.account()) - 1};
    end_piece(i);
  }

  void end_piece(std::size_t i) {
    Run& run = runs_[i];
    const std::shared_ptr<const node::BlockOrder> order = std::exchange(run.order, nullptr);
    received_us_[order->block.account() - 1] += 1e6 * run.cpu_seconds;
    lanes_.queue().serve(kLink, order->block.block(), run.cpu_seconds);
    if (unsent_.contains(order->block.block())) {
      lanes_.queue().remove(kLink, order->block.block());
      progress_.erase(order.get());
    }
    lanes_.end(i, time(), run.cpu_seconds);
    cells_.close(run.lane);
    update();
  }

  void begin_encoding() {
    sending_ = cells_.open(0);
    std::vector<float> cells;
    const std::size_t count = std::min(waiting_tiles_.size(), static_cast<std::size_t>(threads_));
    for (std::size_t i = 0; i < count; ++i) {
      cells.push_back(waiting_tiles_.front().first);
      encoding_.push_back(waiting_tiles_.front().second);
      waiting_tiles_.pop_front();
    }
    begin_step(*sending_, std::move(cells));
    update();
  }

  void encoded() {
    cells_.close(*sending_);
    sending_.reset();
    for (const std::uint64_t block : std::exchange(encoding_, {})) {
      Unsent& frame = unsent_.at(block);
      if (--frame.tiles > 0) continue;
      if (now_ > kWarmUpSeconds) frame_seconds_.push_back(now_ - frame.began);
      order(frame.visit);
      unsent_.erase(block);
    }
  }

  struct Unsent {
    std::size_t tiles = 0;
    double began = 0.0;
    int visit = 0;
  };

  const std::vector<BlockTrace>& blocks_;
  const int threads_;
  double now_ = 0.0;
  node::BlockLanes lanes_;
  render::CellQueue cells_;
  std::vector<Run> runs_;
  std::map<render::CellQueue::Lane, Step> steps_;
  std::map<const node::BlockOrder*, Progress> progress_;
  std::priority_queue<Event> events_;
  int idle_workers_ = 0;
  std::uint64_t ordered_ = 0;
  std::vector<double> received_us_;
  std::deque<std::pair<float, std::uint64_t>> waiting_tiles_;
  std::optional<render::CellQueue::Lane> sending_;
  std::vector<std::uint64_t> encoding_;
  std::map<std::uint64_t, Unsent> unsent_;
  double busy_seconds_ = 0.0;
  std::vector<double> frame_seconds_;
};

}  // namespace

ThreadsUse simulated_use(const std::vector<BlockTrace>& blocks, int threads, std::size_t lanes, int visits,
                         double seconds) {
  return Simulation(blocks, threads, lanes, visits).run(seconds);
}

}  // namespace cyclorama
