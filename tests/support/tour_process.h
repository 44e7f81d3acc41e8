// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "kiosk/tour/session/tour.h"
#include "kiosk/tour/session/tour_service.h"
#include "tests/doubles/fake_farm.h"

namespace cyclorama::tour {

/// The tour's process without its main().
class TourProcess {
 public:
  explicit TourProcess(TourSettings settings) : inspection_("tour") {
    auto tour = Tour::start(std::move(settings), &inspection_);
    CHECK(tour);
    tour_ = *std::move(tour);
    service_.emplace(tour_->displays(), tour_.get(), tour_.get());
    auto server = WireServer::start("[::1]:0", {&*service_, &inspection_});
    CHECK(server);
    server_ = *std::move(server);
  }
  ~TourProcess() { stop(); }
  void stop() {
    tour_->stop();
    server_->stop(std::chrono::milliseconds(200));
  }
  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(server_->port()); }
  [[nodiscard]] std::optional<SavedPosition> position() { return tour_->position(); }
  [[nodiscard]] Tour* operator->() { return tour_.get(); }
  [[nodiscard]] std::string recording() { return tour_->take_recording(); }
  [[nodiscard]] wire::ProcessStatus status() const { return inspection_.status(); }
  [[nodiscard]] double gauge(const std::string& name) const {
    const wire::ProcessStatus now = status();
    for (const auto& gauge : now.gauges()) {
      if (gauge.name() == name) return gauge.value();
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] std::uint64_t stage_count(const std::string& name) const {
    const wire::ProcessStatus now = status();
    for (const auto& stage : now.stages()) {
      if (stage.name() == name) return stage.count();
    }
    return 0;
  }
  /// Polls, since the InspectionService wakes nobody when a value changes.
  bool eventually(const std::function<bool()>& condition) {
    std::mutex mutex;
    std::condition_variable never;
    std::unique_lock lock(mutex);
    const TimePoint end = SteadyClock().now() + std::chrono::seconds(20);
    while (!condition()) {
      if (SteadyClock().now() > end) return false;
      never.wait_for(lock, std::chrono::milliseconds(5));
    }
    return true;
  }
  grpc::Status steer(double forward, double right, double turn) {
    auto channel = make_channel(address());
    CHECK(channel);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
    wire::SteerRequest request;
    request.set_forward(forward);
    request.set_right(right);
    request.set_turn(turn);
    wire::SteerReply reply;
    return wire::Tour::NewStub(*channel)->Steer(&context, request, &reply);
  }

 private:
  InspectionService inspection_;
  std::unique_ptr<Tour> tour_;
  std::optional<TourService> service_;
  std::unique_ptr<WireServer> server_;
};

/// Returns settings with a fixed quality, since the fake farm does not refine.
inline TourSettings settings_for(const FakeFarm& farm) {
  TourSettings settings = default_tour_settings();
  settings.picture.frame_budget_ms = 0.0;
  settings.coordinators = {farm.address()};
  settings.navigation.guide_after = Duration::zero();
  return settings;
}

}  // namespace cyclorama::tour
