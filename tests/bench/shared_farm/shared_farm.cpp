// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/shared_farm/shared_farm.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/check.h"
#include "common/base/cpu_time.h"
#include "tests/doubles/fake_scene.h"

namespace cyclorama {
namespace {

constexpr const char* kScene = "grotto";
/// One way, in the farm's network and between farm and museum.
constexpr Duration kFarmDelay = std::chrono::microseconds(200);
constexpr Duration kMuseumDelay = std::chrono::milliseconds(5);
constexpr Duration kTick = std::chrono::milliseconds(100);
/// Far less than the lowest deadline, so that a deadline in the past does not stop the simulated time.
constexpr Duration kMinWait = std::chrono::milliseconds(1);
constexpr int kWindow = 2;
constexpr double kWalkMetresPerSecond = 0.5;

}  // namespace

double MuseumService::percentile_ms(double share) const {
  if (frame_ms.empty()) return 0.0;
  std::vector<double> sorted = frame_ms;
  const auto index = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size()))) - 1;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(std::min(index, sorted.size() - 1));
  std::ranges::nth_element(sorted, middle);
  return *middle;
}

SharedFarm::SharedFarm()
    : start_(clock_.now()), state_({{kScene, "path"}}, balance::BalanceStrategy::kCostMapStealing, {}, clock_, *this) {
  constexpr int kCalls = 1000;
  for (int i = 0; i < kCalls; ++i) in_coordinator([] {});
  clock_seconds_ = coordinator_seconds_ / kCalls;
  coordinator_seconds_ = 0.0;
}

SharedFarm::~SharedFarm() = default;

double SharedFarm::seconds() const { return to_seconds(clock_.now() - start_); }

TimePoint SharedFarm::time_of(double seconds) const {
  return start_ + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

void SharedFarm::post(TimePoint at, Event event) {
  events_.push_back({at, order_++, std::move(event)});
  std::push_heap(events_.begin(), events_.end());
}

void SharedFarm::at(double seconds, std::function<void()> event) { post(time_of(seconds), std::move(event)); }

void SharedFarm::in_coordinator(const std::function<void()>& call) {
  const double before = thread_cpu_seconds();
  call();
  coordinator_seconds_ += thread_cpu_seconds() - before - clock_seconds_;
}

std::size_t SharedFarm::add_node(int threads, double speed) {
  const coordinator::NodeId id{++last_id_};
  const std::size_t index = nodes_.size();
  auto simulated = std::make_unique<SimulatedNode>(threads, speed);
  nodes_.push_back({std::move(simulated), id, seconds()});
  index_of_.emplace(id, index);
  state_.node_connected(id);
  wire::NodeReport hello;
  hello.mutable_hello()->set_version(CYCLORAMA_VERSION);
  hello.mutable_hello()->set_threads(static_cast<std::uint32_t>(threads));
  hello.mutable_hello()->set_name("node " + std::to_string(index));
  state_.node_reported(id, hello);
  wire::NodeReport loaded;
  loaded.mutable_scene_loaded()->set_scene(kScene);
  *loaded.mutable_scene_loaded()->mutable_description() = fake_scene(kScene);
  loaded.mutable_scene_loaded()->set_probe_cpu_seconds(1.0 / speed);
  state_.node_reported(id, loaded);
  return index;
}

void SharedFarm::remove_node(std::size_t index) {
  Node& node = nodes_.at(index);
  CHECK(node.left_at < 0.0);
  node.left_at = seconds();
  in_coordinator([&] { state_.node_disconnected(node.id); });
}

void SharedFarm::add_museum(const MuseumDemand& demand) {
  services_[demand.name];
  for (int i = 0; i < demand.sessions; ++i)
    at(demand.from_seconds + 0.01 * i, [this, demand] { open_session(demand); });
}

void SharedFarm::open_session(const MuseumDemand& demand) {
  const coordinator::SessionId id{++last_id_};
  Session& session = sessions_.emplace(id, Session{demand}).first->second;
  std::seed_seq seed(demand.name.begin(), demand.name.end());
  session.random.seed(seed);
  wire::SessionRequest open;
  open.mutable_open()->set_museum(demand.name);
  open.mutable_open()->set_frame_budget_ms(demand.budget_ms);
  in_coordinator([&] {
    state_.session_connected(id, {.museum = demand.name});
    state_.session_requested(id, open, clock_.now());
  });
  post(clock_.now() + kMuseumDelay, [this, id] { request(id); });
  const double ends = demand.session_seconds > 0.0 ? seconds() + demand.session_seconds : demand.until_seconds;
  // Not decided by the time then, which is rounded: it may lie before the museum's end, and another session would be
  // opened and closed at the same moment, for ever.
  const bool is_replaced = ends < demand.until_seconds;
  at(std::min(ends, demand.until_seconds), [this, id, demand, is_replaced] {
    if (sessions_.erase(id) == 0) return;
    in_coordinator([&] { state_.session_disconnected(id); });
    if (is_replaced) open_session(demand);
  });
}

void SharedFarm::request(coordinator::SessionId id) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return;
  Session& session = found->second;
  // Uneven, or the phases of the museums would decide who waits for whom.
  const double pause = std::uniform_real_distribution(0.5, 1.5)(session.random) / session.demand.frames_per_second;
  at(seconds() + pause, [this, id] { request(id); });
  if (session.in_flight >= kWindow && !session.demand.ignores_window) return;
  ++session.in_flight;
  ++services_.at(session.demand.name).requested;
  wire::SessionRequest message;
  wire::View& view = *message.mutable_view();
  view.set_number(++session.number);
  view.set_samples(session.demand.samples);
  view.set_bounces(session.demand.bounces);
  view.set_jpeg_quality(80);
  view.mutable_eye_m()->set_x(kWalkMetresPerSecond * seconds());
  view.mutable_panorama()->set_width_px(session.demand.width_px);
  view.mutable_panorama()->set_height_px(session.demand.height_px);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  session.requested_at[view.number()] = clock_.now();
  in_coordinator([&] { state_.session_requested(id, message, clock_.now()); });
}

void SharedFarm::to_node(coordinator::NodeId id, const wire::NodeCommand& command) {
  const std::size_t index = index_of_.at(id);
  post(clock_.now() + kFarmDelay, [this, index, command] {
    if (nodes_[index].left_at >= 0.0) return;
    nodes_[index].node->take(command, clock_.now());
    schedule(index);
  });
}

void SharedFarm::schedule(std::size_t index) {
  Node& node = nodes_[index];
  const auto ends = node.node->piece_ends_at();
  if (!ends || (node.is_scheduled && node.scheduled_at == *ends)) return;
  node.is_scheduled = true;
  node.scheduled_at = *ends;
  post(*ends, [this, index, at = *ends] {
    Node& now = nodes_[index];
    if (now.left_at >= 0.0 || !now.is_scheduled || now.scheduled_at != at) return;
    now.is_scheduled = false;
    for (wire::NodeReport& report : now.node->end_piece(clock_.now())) {
      post(clock_.now() + kFarmDelay, [this, index, report = std::move(report)] {
        if (nodes_[index].left_at >= 0.0) return;
        in_coordinator([&] { state_.node_reported(nodes_[index].id, report); });
      });
    }
    schedule(index);
  });
}

void SharedFarm::to_museum(coordinator::SessionId id, wire::SessionReply reply) {
  // The link takes what it is given at once; only the way takes time.
  post(clock_.now(), [this, id, reply = std::move(reply)] {
    const auto found = sessions_.find(id);
    if (found == sessions_.end()) return;
    if (reply.has_end()) {
      const std::uint64_t number = reply.end().view_number();
      Session& session = found->second;
      MuseumService& service = services_.at(session.demand.name);
      const auto asked = session.requested_at.find(number);
      if (asked != session.requested_at.end()) {
        ++(reply.end().complete() ? service.complete : service.given_up);
        if (reply.end().complete()) service.frame_ms.push_back(1e3 * to_seconds(clock_.now() - asked->second));
        session.requested_at.erase(session.requested_at.begin(), std::next(asked));
        post(clock_.now() + kMuseumDelay, [this, id] {
          const auto still = sessions_.find(id);
          if (still != sessions_.end()) still->second.in_flight = static_cast<int>(still->second.requested_at.size());
        });
      }
    }
    in_coordinator([&] { state_.written(id, reply); });
  });
}

void SharedFarm::end_node(coordinator::NodeId, const Error& reason) { CHECK(reason.message().empty()); }

void SharedFarm::end_session(coordinator::SessionId id, const Error&, bool) { sessions_.erase(id); }

void SharedFarm::frame_ended(const coordinator::FrameReport& report) {
  services_.at(report.museum).cpu_seconds += report.cpu_seconds;
}

void SharedFarm::run(double duration) {
  const TimePoint end = clock_.now() + (time_of(duration) - start_);
  TimePoint next_tick = clock_.now();
  while (clock_.now() < end) {
    TimePoint wake = std::min({next_tick, end, std::max(state_.next_deadline(), clock_.now() + kMinWait)});
    if (!events_.empty() && events_.front().at <= wake) {
      std::pop_heap(events_.begin(), events_.end());
      const Scheduled next = std::move(events_.back());
      events_.pop_back();
      clock_.set(std::max(clock_.now(), next.at));
      next.event();
      continue;
    }
    clock_.set(wake);
    in_coordinator([&] { state_.tick(); });
    if (wake >= next_tick) next_tick = wake + kTick;
  }
}

void SharedFarm::forget_services() {
  for (auto& [name, service] : services_) service = {};
  coordinator_seconds_ = 0.0;
}

double SharedFarm::busy_seconds() const {
  double sum = 0.0;
  for (const Node& node : nodes_) sum += node.node->busy_seconds();
  return sum;
}

double SharedFarm::possible_seconds() const {
  double sum = 0.0;
  for (const Node& node : nodes_) {
    sum += node.node->threads() * ((node.left_at < 0.0 ? seconds() : node.left_at) - node.came_at);
  }
  return sum;
}

std::size_t SharedFarm::nodes_used() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(nodes_, [](const Node& node) { return node.node->busy_seconds() > 0.0; }));
}

}  // namespace cyclorama
