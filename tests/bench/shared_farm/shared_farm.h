// SPDX-License-Identifier: Apache-2.0
/// A farm that many museums share, in simulated time: the real coordinator's state, the nodes' real queues, and museums
/// and rays that are simulated.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "renderfarm/coordinator/coordinator_state.h"
#include "tests/bench/shared_farm/simulated_node.h"
#include "tests/doubles/fake_clock.h"

namespace cyclorama {

/// The requests of a museum. Times are in seconds.
struct MuseumDemand {
  std::string name{};
  double frames_per_second = 10.0;
  std::uint32_t width_px = 1024;
  std::uint32_t height_px = 512;
  std::uint32_t samples = 1;
  std::uint32_t bounces = 4;
  double budget_ms = 0.0;        ///< 0: the views set their quality.
  int sessions = 1;              ///< At once.
  double session_seconds = 0.0;  ///< Each session is closed after this time and replaced at once; 0: never.
  bool ignores_window = false;   ///< Requests at its rate, whatever the farm has answered.
  double from_seconds = 0.0;
  double until_seconds = 1e9;
};

/// The service that a museum got. Times are from a view's arrival at the farm to the last byte's departure.
struct MuseumService {
  double cpu_seconds = 0.0;
  int requested = 0;
  int complete = 0;
  int given_up = 0;
  std::vector<double> frame_ms{};  ///< Complete frames.
  [[nodiscard]] double percentile_ms(double share) const;
};

/// Thread-bound.
class SharedFarm final : private coordinator::CoordinatorDelegate {
 public:
  SharedFarm();
  ~SharedFarm() override;
  SharedFarm(const SharedFarm&) = delete;
  SharedFarm& operator=(const SharedFarm&) = delete;

  /// Returns the node's index.
  std::size_t add_node(int threads, double speed = 1.0);
  void remove_node(std::size_t index);
  void add_museum(const MuseumDemand& demand);
  /// Calls `event` after that time from the start.
  void at(double seconds, std::function<void()> event);
  void run(double seconds);

  [[nodiscard]] const std::map<std::string, MuseumService>& services() const { return services_; }
  /// Begins to measure: services, and the coordinator's time, count from now on.
  void forget_services();
  /// Thread-seconds that all nodes worked, also those that left.
  [[nodiscard]] double busy_seconds() const;
  /// Thread-seconds that they could have worked.
  [[nodiscard]] double possible_seconds() const;
  /// Real processor time of the coordinator's state.
  [[nodiscard]] double coordinator_seconds() const { return coordinator_seconds_; }
  /// Number of nodes that ever worked.
  [[nodiscard]] std::size_t nodes_used() const;

 private:
  struct Node {
    std::unique_ptr<SimulatedNode> node;
    coordinator::NodeId id{};
    double came_at = 0.0;
    double left_at = -1.0;
    bool is_scheduled = false;
    TimePoint scheduled_at{};
  };
  struct Session {
    MuseumDemand demand;
    std::uint64_t number = 0;  ///< The last view's.
    int in_flight = 0;
    std::map<std::uint64_t, TimePoint> requested_at{};
    /// Generates the times between two requests. Each museum has one of its own, so that its requests do not depend on
    /// the others.
    std::mt19937 random{};
  };
  using Event = std::function<void()>;
  struct Scheduled {
    TimePoint at;
    std::uint64_t order = 0;
    Event event;
    friend bool operator<(const Scheduled& a, const Scheduled& b) {
      return a.at != b.at ? a.at > b.at : a.order > b.order;
    }
  };

  void to_node(coordinator::NodeId node, const wire::NodeCommand& command) override;
  void to_museum(coordinator::SessionId session, wire::SessionReply reply) override;
  void accept_light(const wire::LightVersion&) override {}
  void forget_light(const wire::LightVersion&) override {}
  void end_node(coordinator::NodeId node, const Error& reason) override;
  void end_session(coordinator::SessionId session, const Error& reason, bool at_once) override;
  void frame_ended(const coordinator::FrameReport& report) override;
  void notice(const std::string&, const coordinator::NoticeAbout&) override {}

  void post(TimePoint at, Event event);
  /// Runs a call of the coordinator's state, and counts its time.
  void in_coordinator(const std::function<void()>& call);
  void open_session(const MuseumDemand& demand);
  void request(coordinator::SessionId id);
  void schedule(std::size_t index);
  [[nodiscard]] double seconds() const;
  [[nodiscard]] TimePoint time_of(double seconds) const;

  FakeClock clock_;
  const TimePoint start_;
  coordinator::CoordinatorState state_;
  std::vector<Node> nodes_;
  std::map<coordinator::NodeId, std::size_t> index_of_;
  std::map<coordinator::SessionId, Session> sessions_;
  std::map<std::string, MuseumService> services_;
  std::vector<Scheduled> events_;  ///< A heap; the next is the first.
  std::uint64_t order_ = 0;
  std::uint64_t last_id_ = 0;
  double coordinator_seconds_ = 0.0;
  double clock_seconds_ = 0.0;  ///< Time that measuring adds to each call of the coordinator's state.
};

}  // namespace cyclorama
