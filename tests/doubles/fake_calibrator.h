// SPDX-License-Identifier: Apache-2.0
/// A calibrator that measures nothing: it reports what a test sets and records its requests.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"
#include "common/wire/inspection_service.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama {

/// Returns the progress messages of a successful calibration with `steps` patterns, each with the picture `jpeg`.
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

/// Publishes the inspection tables of a calibrator that keeps three projectors aligned, one of which was bumped four
/// minutes ago.
inline void tell_healing(InspectionService* inspection) {
  inspection->set_fact("watch",
                       "keeps 2 of 3 projectors in place; 'right' is left as it is: something stands in the way");
  wire::Table now;
  now.set_name("watched projectors");
  for (const char* column : {"projector", "state", "reason", "off_px", "sigma_px", "corrections", "last_correction_px",
                             "last_correction_s", "wants_scan"})
    now.add_columns(column);
  wire::Table past;
  past.set_name("watched history");
  past.add_columns("s");
  for (int i = 0; i < 3; ++i) {
    const std::string name = i == 0 ? "left" : i == 1 ? "middle" : "right";
    wire::Row* const row = now.add_rows();
    row->add_cells()->set_text(name);
    row->add_cells()->set_text(i == 2 ? "in the way" : "good");
    row->add_cells()->set_text(i == 2 ? "something stands in the way of 41 of 96 places" : "");
    row->add_cells()->set_number(0.06 + 0.03 * i);
    row->add_cells()->set_number(0.11);
    row->add_cells()->set_number(i == 1 ? 1 : 0);
    if (i == 1) row->add_cells()->set_number(23.4);
    if (i == 1) row->add_cells()->set_number(241.0);
    if (i != 1) row->add_cells();
    if (i != 1) row->add_cells();
    row->add_cells()->set_number(0.0);
    past.add_columns(name);
  }
  for (int k = 120; k >= 0; --k) {
    wire::Row* const row = past.add_rows();
    row->add_cells()->set_number(5.0 * k);
    for (int i = 0; i < 3; ++i) {
      wire::Cell* const cell = row->add_cells();
      const bool is_hidden = i == 2 && k < 20 && k > 8;
      if (!is_hidden) cell->set_number(i == 1 && k == 48 ? 23.4 : 0.05 + 0.02 * ((k * (i + 3)) % 5));
    }
  }
  inspection->set_table(now);
  inspection->set_table(past);
}

/// Listens on [::1] as long as it exists. Thread-safe, except for the members that a test sets before the first
/// request.
class FakeCalibrator final : private wire::Calibrator::Service {
 public:
  FakeCalibrator() {
    auto server = WireServer::start("[::1]:0", {static_cast<wire::Calibrator::Service*>(this), &inspection, &healing});
    CHECK(server.has_value());
    server_ = *std::move(server);
  }
  ~FakeCalibrator() override { server_->stop(Duration::zero()); }
  FakeCalibrator(const FakeCalibrator&) = delete;
  FakeCalibrator& operator=(const FakeCalibrator&) = delete;

  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(server_->port()); }
  /// Waits until a call is cancelled.
  bool wait_for_cancel() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [this] { return was_cancelled_; });
  }
  bool wait_for_order() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [this] { return !orders.empty(); });
  }

  InspectionService inspection{"calibrator"};
  /// Counts realignment requests. Reverts `corrections`, none of which was really made.
  struct Healing final : wire::Healing::Service {
    grpc::Status Realign(grpc::ServerContext*, const wire::RealignRequest* order, wire::RealignReply* answer) override {
      if (order->undo()) {
        if (corrections == 0) return {grpc::StatusCode::NOT_FOUND, "no correction stands that could be undone"};
        answer->set_undone("projector 'middle' is drawn for as before correction " + std::to_string(corrections--));
        return grpc::Status::OK;
      }
      ++realigned;
      return is_watching ? grpc::Status::OK
                         : grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "nothing watches the wall");
    }
    /// Reports one camera that is located and one that sees too little.
    grpc::Status PlaceCameras(grpc::ServerContext* context, const wire::PlaceCamerasRequest*,
                              wire::PlacedCameras* reply) override {
      while (is_placing && !context->IsCancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (context->IsCancelled()) return grpc::Status::CANCELLED;
      if (!is_watching) return {grpc::StatusCode::NOT_FOUND, "no camera watches; name one in calibrator.toml"};
      wire::PlacedCameras::Camera* const left = reply->add_cameras();
      left->set_name("left");
      left->set_places(2814);
      left->set_rms_px(0.04);
      reply->add_cameras()->set_trouble("camera 'right' sees no projector's light; turn it to the wall");
      return grpc::Status::OK;
    }
    std::atomic<bool> is_placing{false};  ///< While true, PlaceCameras() waits.
    std::atomic<int> realigned{0};
    std::atomic<int> corrections{1};  ///< Number of corrections that can be undone.
    std::atomic<bool> is_watching{true};
  } healing;

  // To be set before the first request, and only read afterwards:
  std::vector<wire::CalibrateProgress> messages = told_calibration(4, "a picture");
  Duration step_takes = Duration::zero();  ///< Delay after each message.
  std::atomic<bool> is_held{false};        ///< While true, a call waits after its current message.
  grpc::Status end = grpc::Status::OK;
  std::string restored_date = "2026-10-01";  ///< Date of the restored calibration; empty if there is none.
  std::vector<wire::CalibrateRequest> orders;
  std::vector<std::string> answers;

 private:
  grpc::Status Calibrate(grpc::ServerContext* context, const wire::CalibrateRequest* order,
                         grpc::ServerWriter<wire::CalibrateProgress>* writer) override {
    std::unique_lock lock(mutex_);
    orders.push_back(*order);
    changed_.notify_all();
    for (const wire::CalibrateProgress& message : messages) {
      writer->Write(message);
      // A question is followed by the next message only once an answer has arrived.
      const std::size_t heard = answers.size();
      while (!message.question().empty() && answers.size() == heard && !context->IsCancelled())
        changed_.wait_for(lock, std::chrono::milliseconds(2));
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
  grpc::Status Answer(grpc::ServerContext*, const wire::AnswerRequest* order, wire::AnswerReply*) override {
    const std::lock_guard lock(mutex_);
    if (orders.empty()) return {grpc::StatusCode::FAILED_PRECONDITION, "nothing is asked"};
    answers.push_back(order->text());
    changed_.notify_all();
    return grpc::Status::OK;
  }
  grpc::Status Restore(grpc::ServerContext*, const wire::RestoreRequest*, wire::RestoreReply* answer) override {
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
