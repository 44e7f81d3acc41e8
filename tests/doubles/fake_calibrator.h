// SPDX-License-Identifier: Apache-2.0
/// A calibrator that tells what a test wants, and remembers what it was asked.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"

namespace cyclorama {

/// Listens on [::1] as long as it lives. Thread-safe.
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
  std::vector<wire::CalibrateProgress> messages;
  bool goes_on_for_ever = false;  ///< After the messages, until it is cancelled.
  grpc::Status end = grpc::Status::OK;
  std::string restored_date;  ///< Empty: there is none.
  std::vector<wire::CalibrateOrder> orders;

 private:
  grpc::Status Calibrate(grpc::ServerContext* context, const wire::CalibrateOrder* order,
                         grpc::ServerWriter<wire::CalibrateProgress>* writer) override {
    {
      const std::lock_guard lock(mutex_);
      orders.push_back(*order);
      changed_.notify_all();
    }
    for (const wire::CalibrateProgress& message : messages) writer->Write(message);
    std::unique_lock lock(mutex_);
    while (goes_on_for_ever && !context->IsCancelled()) changed_.wait_for(lock, std::chrono::milliseconds(10));
    was_cancelled_ = context->IsCancelled();
    changed_.notify_all();
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
