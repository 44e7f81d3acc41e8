// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>

#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"

namespace cyclorama {

/// Calibrates nothing, in `steps` steps, each of which waits for allow() unless it is free. Thread-safe.
class SteppedCalibrator final : public wire::Calibrator::Service {
 public:
  explicit SteppedCalibrator(int steps = 4, Duration step_takes = Duration::zero(), int port = 0)
      : steps_(steps), step_takes_(step_takes) {
    auto server = WireServer::start("[::1]:" + std::to_string(port), {this});
    CHECK(server);
    server_ = *std::move(server);
  }
  ~SteppedCalibrator() override { server_->stop(Duration::zero()); }
  SteppedCalibrator(const SteppedCalibrator&) = delete;
  SteppedCalibrator& operator=(const SteppedCalibrator&) = delete;
  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(server_->port()); }

  std::atomic<bool> is_held{false};  ///< Stays at its first step until it is cancelled.
  std::atomic<bool> is_broken{false};
  std::atomic<bool> was_cancelled{false};
  std::atomic<bool> has_before{true};
  std::string jpeg;  ///< Set before it is used.

 private:
  grpc::Status Calibrate(grpc::ServerContext* context, const wire::CalibrateOrder*,
                         grpc::ServerWriter<wire::CalibrateProgress>* writer) override {
    for (int step = 0; step < steps_; ++step) {
      wire::CalibrateProgress progress;
      progress.set_step("shows pattern " + std::to_string(step + 1) + " of " + std::to_string(steps_));
      progress.set_fraction(static_cast<double>(step) / steps_);
      progress.set_jpeg(jpeg);
      writer->Write(progress);
      const TimePoint until = SteadyClock().now() + step_takes_;
      while ((is_held || SteadyClock().now() < until) && !context->IsCancelled())
        SteadyClock().wait_until(SteadyClock().now() + std::chrono::milliseconds(2));
      if (context->IsCancelled()) {
        was_cancelled = true;
        return grpc::Status::CANCELLED;
      }
      if (is_broken) return to_grpc(Error(ErrorCode::kUnavailable, "projector 'left' is dark; switch it on"));
    }
    wire::CalibrateProgress progress;
    progress.set_step("done");
    progress.set_fraction(1.0);
    progress.mutable_done()->set_date("2026-11-22");
    progress.mutable_done()->set_registration_p95_px(0.31);
    progress.mutable_done()->add_remarks("Projector 'right' overlaps by 3 degrees only; turn it to the left.");
    writer->Write(progress);
    return grpc::Status::OK;
  }
  grpc::Status Restore(grpc::ServerContext*, const wire::RestoreOrder*, wire::RestoreAnswer* answer) override {
    if (!has_before) return to_grpc(Error(ErrorCode::kNotFound, "there is no calibration of before"));
    answer->set_date("2026-10-01");
    return grpc::Status::OK;
  }
  const int steps_;
  const Duration step_takes_;
  std::unique_ptr<WireServer> server_;
};

}  // namespace cyclorama
