// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/calibrator_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "appliance/calibration/calibration_file.h"
#include "appliance/scan/realign/realignment.h"
#include "common/image/jpeg.h"
#include "common/wire/channel.h"

namespace cyclorama::calibrator {
namespace {

constexpr Duration kReportEvery = std::chrono::milliseconds(200);
constexpr Duration kPictureEvery = std::chrono::seconds(1);
constexpr int kPictureWidth_px = 640;
/// Longest time without progress. A photograph follows another within seconds, even when it is taken again; the wall of
/// many projectors is computed for minutes on a slow computer.
constexpr Duration kPhotographTimeout = std::chrono::minutes(5);
constexpr Duration kStepTimeout = std::chrono::minutes(30);

grpc::Status refused(const std::string& why) { return {grpc::StatusCode::FAILED_PRECONDITION, why}; }

/// Returns a small preview for a page: every n-th pixel.
RgbImage preview_of(const scan::ScanPhotograph& photograph) {
  const int every = std::max(1, photograph.width() / kPictureWidth_px);
  RgbImage picture(photograph.width() / every, photograph.height() / every);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const float* code = photograph.at(x * every, y * every);
      for (int c = 0; c < 3; ++c) {
        picture.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(code[c], 0.0f, 1.0f)));
      }
    }
  }
  return picture;
}

}  // namespace

CalibratorService::CalibratorService(Installation installation, std::filesystem::path folder, DeviceOpener opener,
                                     const Clock& clock, InspectionService* inspection)
    : installation_(std::move(installation)),
      folder_(std::move(folder)),
      opener_(std::move(opener)),
      clock_(clock),
      inspection_(inspection) {
  say("waits for a calibration request", true);
}

void CalibratorService::stop() { stop_.request_stop(); }

std::string CalibratorService::state() const {
  const std::lock_guard lock(mutex_);
  return also_.empty() ? state_ : state_ + "; " + also_;
}

void CalibratorService::say(std::string sentence, bool is_healthy) {
  {
    const std::lock_guard lock(mutex_);
    state_ = std::move(sentence);
    is_healthy_ = is_healthy;
  }
  tell();
}

void CalibratorService::also(std::string sentence, bool is_healthy) {
  {
    const std::lock_guard lock(mutex_);
    also_ = std::move(sentence);
    is_also_healthy_ = is_healthy;
  }
  tell();
}

void CalibratorService::tell() {
  bool is_healthy = false;
  {
    const std::lock_guard lock(mutex_);
    is_healthy = is_healthy_ && is_also_healthy_;
  }
  inspection_->set_state(state(), is_healthy);
}

Result<scan::CalibrationOutcome> CalibratorService::calibrate(const wire::CalibrateRequest& order,
                                                              const scan::ScanListener& listener,
                                                              std::stop_token stop) {
  listener({"opens camera, turntable and projectors", 0.0, nullptr});
  TRY_ASSIGN(CalibrationDevices devices, opener_());
  devices.settings.resume = order.resume();
  const scan::ScanDevices scan{*devices.screen, *devices.camera, *devices.turntable, devices.colour_camera.get()};
  if (order.quick()) {
    TRY_ASSIGN(scan::RealignmentOutcome realigned,
               scan::realign_projector(installation_, order.projector(), devices.settings, scan, folder_,
                                       scan::calibration_date(), clock_, listener, std::move(stop)));
    return std::move(realigned.outcome);
  }
  return scan::run_calibration(installation_, devices.settings, scan, folder_, scan::calibration_date(), clock_,
                               listener, std::move(stop));
}

grpc::Status CalibratorService::Calibrate(grpc::ServerContext* context, const wire::CalibrateRequest* request,
                                          grpc::ServerWriter<wire::CalibrateProgress>* writer) {
  const std::unique_lock working(busy_, std::try_to_lock);
  if (!working) return refused("a calibration runs already; wait for its end, or cancel it");
  if (stop_.stop_requested()) return {grpc::StatusCode::UNAVAILABLE, "the calibrator stops"};
  if (request->quick() && (request->projector().empty() || request->resume())) {
    return {grpc::StatusCode::INVALID_ARGUMENT,
            "a quick calibration is of one projector, which is named, and is not resumed"};
  }
  const std::shared_ptr<void> held = hold_ ? hold_() : nullptr;
  std::stop_source stop;
  const std::stop_callback process_stops(stop_.get_token(), [&] { stop.request_stop(); });
  liveness_.expect_by(clock_.now() + kStepTimeout);
  const auto rest = [this](void*) { liveness_.rest(); };
  const std::unique_ptr<void, decltype(rest)> at_the_end(this, rest);
  JpegEncoder encoder;
  TimePoint told_at{};
  TimePoint pictured_at{};
  std::string told;
  double fraction = 0.0;
  const scan::ScanListener listener = [&](const scan::ScanProgress& progress) {
    const TimePoint now = clock_.now();
    liveness_.expect_by(now + (progress.newest != nullptr ? kPhotographTimeout : kStepTimeout));
    fraction = progress.fraction;
    say(fmt::format("is calibrating, {:.0f} %: {}", 100.0 * progress.fraction, progress.step), true);
    inspection_->set_gauge("calibrated_fraction", progress.fraction);
    if (context->IsCancelled()) stop.request_stop();
    const bool is_another_step = progress.newest == nullptr && progress.step != told;
    if (!is_another_step && now - told_at < kReportEvery) return;
    told_at = now;
    told = progress.step;
    wire::CalibrateProgress message;
    message.set_step(progress.step);
    message.set_fraction(progress.fraction);
    if (progress.newest != nullptr && now - pictured_at >= kPictureEvery) {
      pictured_at = now;
      const auto preview = std::make_shared<const RgbImage>(preview_of(*progress.newest));
      inspection_->set_picture("camera", preview);
      if (const auto jpeg = encoder.encode(*preview, {})) {
        message.set_jpeg(std::string(reinterpret_cast<const char*>(jpeg->data()), jpeg->size()));
      }
    }
    if (!writer->Write(message)) stop.request_stop();  // The client is gone, which counts as a cancellation.
  };
  std::string asked;
  const TurntablePrompt::Listener questions = [&](const std::string& question) {
    liveness_.expect_by(clock_.now() + kStepTimeout);
    if (context->IsCancelled() || stop.stop_requested()) {
      stop.request_stop();
      return false;
    }
    if (question == asked) return true;
    asked = question;
    if (!question.empty()) say("asks at the turntable: " + question, true);
    wire::CalibrateProgress message;
    message.set_step(told);
    message.set_fraction(fraction);
    message.set_question(question);
    return writer->Write(message);
  };
  if (prompt_ != nullptr) prompt_->set_listener(questions);
  const auto outcome = calibrate(*request, listener, stop.get_token());
  if (prompt_ != nullptr) prompt_->set_listener(nullptr);
  if (!outcome) {
    if (stop.stop_requested()) {
      say("waits for a calibration request; the last calibration was cancelled", true);
      return {grpc::StatusCode::CANCELLED, scan::cancelled().message()};
    }
    say("could not calibrate: " + outcome.error().message(), false);
    if (outcome.error().code() == ErrorCode::kNotFound && request->resume()) return refused(outcome.error().message());
    return to_grpc(outcome.error());
  }
  const calibration::Calibration& calibration = outcome->calibration;
  say(fmt::format("calibrated {} projectors on {}", calibration.projectors.size(), calibration.date), true);
  inspection_->set_gauge("registration_p95_px", outcome->registration.p95_px);
  inspection_->set_fact("calibration", calibration.date);
  wire::CalibrateProgress last;
  last.set_step("is calibrated");
  last.set_fraction(1.0);
  last.mutable_done()->set_date(calibration.date);
  for (const std::string& remark : calibration.remarks) last.mutable_done()->add_remarks(remark);
  last.mutable_done()->set_registration_p95_px(outcome->registration.p95_px);
  last.mutable_done()->set_report_path(outcome->report.string());
  writer->Write(last);
  return grpc::Status::OK;
}

grpc::Status CalibratorService::Answer(grpc::ServerContext*, const wire::AnswerRequest* request, wire::AnswerReply*) {
  if (prompt_ != nullptr && prompt_->answer(request->text())) return grpc::Status::OK;
  return refused("no question is open any more");
}

grpc::Status CalibratorService::Restore(grpc::ServerContext*, const wire::RestoreRequest*, wire::RestoreReply* reply) {
  const std::unique_lock working(busy_, std::try_to_lock);
  if (!working) return refused("a calibration runs; wait for its end, or cancel it");
  const auto now = calibration::read_calibration(folder_);
  if (!now && now.error().code() != ErrorCode::kNotFound && now.error().code() != ErrorCode::kBadData) {
    return to_grpc(now.error());
  }
  // Chooses the newest calibration older than the current one; if the current one is unreadable, the newest of all.
  for (const std::string& date : calibration::kept_calibrations(folder_)) {
    if (now && date >= now->date) continue;
    if (auto restored = calibration::restore_calibration(folder_, date); !restored) return to_grpc(restored.error());
    say("went back to the calibration of " + date, true);
    inspection_->set_fact("calibration", date);
    reply->set_date(date);
    return grpc::Status::OK;
  }
  return {grpc::StatusCode::NOT_FOUND, "there is no previous calibration; calibrate"};
}

}  // namespace cyclorama::calibrator
