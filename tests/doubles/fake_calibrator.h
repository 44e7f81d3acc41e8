// SPDX-License-Identifier: Apache-2.0
/// A calibrator that measures nothing: it tells what a test wants, and remembers what it was asked.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"

namespace cyclorama {

/// `steps` patterns, each with `jpeg`, and a good end.
inline std::vector<wire::CalibrateProgress> told_calibration(int steps, const std::string& jpeg) {
  std::vector<wire::CalibrateProgress> messages;
  for (int step = 0; step < steps; ++step) {
    wire::CalibrateProgress& message = messages.emplace_back();
    message.set_step("shows pattern " + std::to_string(step + 1) + " of " + std::to_string(steps));
    message.set_fraction(static_cast<double>(step) / steps);
    message.set_jpeg(jpeg);
  }
  wire::CalibrateProgress& last = messages.emplace_back();
  last.set_step("done");
  last.set_fraction(1.0);
  last.mutable_done()->set_date("2026-11-22");
  last.mutable_done()->set_registration_p95_px(0.31);
  last.mutable_done()->add_remarks("Projector 'right' overlaps by 3 degrees only; turn it to the left.");
  return messages;
}

/// Listens on [::1] as long as it lives. Thread-safe, but for what is set before it is asked.
class FakeCalibrator final : private wire::Calibrator::Service {
 public:
  FakeCalibrator() {
    auto server = WireServer::start("[::1]:0", {static_cast<wire::Calibrator::Service*>(this)});
    CHECK(server.has_value());
    server_ = *std::move(server);
  }
  ~FakeCalibrator() override { server_->stop(Duration::zero()); }
  FakeCalibrator(const FakeCalibrator&) = delete;
  FakeCalibrator& operator=(const FakeCalibrator&) = delete;

  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(server_->port()); }
  /// Until a call was cancelled.
  bool wait_for_cancel() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [this] { return was_cancelled_; });
  }
  bool wait_for_order() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [this] { return !orders.empty(); });
  }

  // Set before, read after.
  std::vector<wire::CalibrateProgress> messages = told_calibration(4, "a picture");
  Duration step_takes = Duration::zero();  ///< Passes after each message.
  std::atomic<bool> is_held{false};        ///< Goes no further than that, until it is cancelled.
  grpc::Status end = grpc::Status::OK;
  std::string restored_date = "2026-10-01";  ///< Empty: there is none.
  std::vector<wire::CalibrateOrder> orders;

 private:
  grpc::Status Calibrate(grpc::ServerContext* context, const wire::CalibrateOrder* order,
                         grpc::ServerWriter<wire::CalibrateProgress>* writer) override {
    std::unique_lock lock(mutex_);
    orders.push_back(*order);
    changed_.notify_all();
    for (const wire::CalibrateProgress& message : messages) {
      writer->Write(message);
      const TimePoint until = SteadyClock().now() + step_takes;
      while ((is_held || SteadyClock().now() < until) && !context->IsCancelled())
        changed_.wait_for(lock, std::chrono::milliseconds(2));
      if (!context->IsCancelled()) continue;
      was_cancelled_ = true;
      changed_.notify_all();
      return grpc::Status::CANCELLED;
    }
    return end;
  }
  grpc::Status Restore(grpc::ServerContext*, const wire::RestoreOrder*, wire::RestoreAnswer* answer) override {
    if (restored_date.empty()) return {grpc::StatusCode::NOT_FOUND, "there is no calibration of before"};
    answer->set_date(restored_date);
    return grpc::Status::OK;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool was_cancelled_ = false;
  std::unique_ptr<WireServer> server_;
};

}  // namespace cyclorama
