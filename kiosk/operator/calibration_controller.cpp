// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/calibration_controller.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/text.h"
#include "common/wire/channel.h"

namespace cyclorama::operations {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto kAnswerDeadline = std::chrono::seconds(5);
constexpr auto kRestoreDeadline = std::chrono::seconds(30);
constexpr auto kToPlace = std::chrono::minutes(20);
constexpr std::size_t kMaxPictureBytes = 4 << 20;
constexpr int kMaxRemarks = 100;

}  // namespace

Result<std::unique_ptr<CalibrationController>> CalibrationController::make(const std::string& address) {
  TRY_ASSIGN(const auto channel, make_channel(address));
  return std::unique_ptr<CalibrationController>(new CalibrationController(channel));
}

CalibrationController::CalibrationController(const std::shared_ptr<grpc::Channel>& channel)
    : calibrator_(wire::Calibrator::NewStub(channel)), healing_(wire::Healing::NewStub(channel)) {}

CalibrationController::~CalibrationController() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

Status CalibrationController::start(const wire::CalibrateRequest& order) {
  return begin("wall", "connects to the calibrator",
               [this, order](grpc::ClientContext* context) { calibrate(order, context); });
}

Status CalibrationController::place_cameras() {
  return begin("cameras", "It shows patterns to the fixed cameras, for a minute or two.",
               [this](grpc::ClientContext* context) { place(context); });
}

Status CalibrationController::begin(const char* what, const char* step,
                                    std::function<void(grpc::ClientContext*)> work) {
  const std::lock_guard ordering(ordering_);
  auto context = std::make_shared<grpc::ClientContext>();
  {
    const std::lock_guard lock(mutex_);
    if (running_) return Error(ErrorCode::kBusy, "a calibration runs already; wait for it or cancel it");
    running_ = context;
    what_ = what;
    state_ = "running";
    error_.clear();
    is_cancelled_ = false;
    newest_.Clear();
    newest_.set_step(step);
    jpeg_.clear();
  }
  if (thread_.joinable()) thread_.join();  // Does not block: nothing is running, so the thread has ended.
  thread_ = std::thread([work = std::move(work), context] { work(context.get()); });
  return Done{};
}

void CalibrationController::calibrate(const wire::CalibrateRequest& order, grpc::ClientContext* context) {
  const auto reader = calibrator_->Calibrate(context, order);
  wire::CalibrateProgress progress;
  bool is_done = false;
  while (reader->Read(&progress)) {
    const std::lock_guard lock(mutex_);
    if (!progress.jpeg().empty() && progress.jpeg().size() <= kMaxPictureBytes) jpeg_ = progress.jpeg();
    progress.clear_jpeg();
    is_done = is_done || progress.has_done();
    newest_ = progress;
  }
  const grpc::Status status = finish_after_read(*context, [&] { return reader->Finish(); });
  const std::lock_guard lock(mutex_);
  end(is_done, status, "calibrating");
}

void CalibrationController::place(grpc::ClientContext* context) {
  context->set_deadline(std::chrono::system_clock::now() + kToPlace);
  wire::PlacedCameras placed;
  const grpc::Status status = healing_->PlaceCameras(context, wire::PlaceCamerasRequest(), &placed);
  const std::lock_guard lock(mutex_);
  if (status.ok()) {
    newest_.set_fraction(1.0);
    newest_.mutable_done();
    for (const wire::PlacedCameras::Camera& camera : placed.cameras()) {
      newest_.mutable_done()->add_remarks(camera.trouble().empty()
                                              ? fmt::format("Camera '{}' saw {} places of the wall, off by {:.2f} px.",
                                                            printable(camera.name()), camera.places(), camera.rms_px())
                                              : "Not placed: " + printable(camera.trouble(), 500));
    }
  }
  end(status.ok(), status, "locating the cameras");
}

void CalibrationController::end(bool is_done, const grpc::Status& status, const char* doing) {
  running_ = nullptr;
  if (is_done && status.ok()) {
    state_ = "done";
  } else if (is_cancelled_) {
    state_ = "cancelled";
  } else {
    state_ = "failed";
    error_ = status.ok() ? "The calibrator ended without a result; start the calibration again."
                         : printable(from_grpc(status, doing).message(), 1000);
  }
}

void CalibrationController::cancel() {
  const std::lock_guard lock(mutex_);
  if (!running_) return;
  is_cancelled_ = true;
  running_->TryCancel();
}

Status CalibrationController::answer(const std::string& text) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kAnswerDeadline);
  wire::AnswerRequest order;
  order.set_text(text);
  wire::AnswerReply reply;
  const grpc::Status status = calibrator_->Answer(&context, order, &reply);
  if (status.error_code() == grpc::StatusCode::FAILED_PRECONDITION)
    return Error(ErrorCode::kNotFound, "the calibration has no open question any more");
  return status.ok() ? Status(Done{}) : from_grpc(status, "answering the calibration");
}

Result<std::string> CalibrationController::restore() {
  {
    const std::lock_guard lock(mutex_);
    if (running_) return Error(ErrorCode::kBusy, "a calibration runs; cancel it first");
  }
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kRestoreDeadline);
  wire::RestoreReply answer;
  const grpc::Status status = calibrator_->Restore(&context, wire::RestoreRequest(), &answer);
  if (!status.ok()) return from_grpc(status, "restoring the previous calibration");
  return printable(answer.date(), 100);
}

std::string CalibrationController::json() const {
  const std::lock_guard lock(mutex_);
  const double fraction = std::isfinite(newest_.fraction()) ? std::clamp(newest_.fraction(), 0.0, 1.0) : 0.0;
  Json json{{"what", what_},
            {"state", state_},
            {"step", printable(newest_.step(), 300)},
            {"fraction", fraction},
            {"error", error_},
            {"date", printable(newest_.done().date(), 100)},
            {"remarks", Json::array()},
            {"registration_p95_px", nullptr},
            {"has_picture", !jpeg_.empty()},
            {"question", running_ ? printable(newest_.question(), 300) : ""}};
  if (newest_.has_done()) {
    const double error_px = newest_.done().registration_p95_px();
    if (std::isfinite(error_px)) json["registration_p95_px"] = error_px;
    for (const std::string& remark : newest_.done().remarks()) {
      if (json["remarks"].size() < kMaxRemarks) json["remarks"].push_back(printable(remark, 500));
    }
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

std::string CalibrationController::picture() const {
  const std::lock_guard lock(mutex_);
  return jpeg_;
}

Result<CalibrationRequest> parse_calibration_request(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  const auto bad = [](std::string_view what) { return Error(ErrorCode::kBadData, std::string(what)); };
  if (!json.is_object()) return bad("not a JSON object; send {\"do\": \"start\"}");
  CalibrationRequest wanted;
  std::string kind;
  bool has_text = false;
  for (const auto& [key, value] : json.items()) {
    if (key == "do" && value.is_string()) {
      kind = value.get<std::string>();
    } else if (key == "quick" && value.is_boolean()) {
      wanted.order.set_quick(value.get<bool>());
    } else if (key == "resume" && value.is_boolean()) {
      wanted.order.set_resume(value.get<bool>());
    } else if (key == "projector" && value.is_string()) {
      wanted.order.set_projector(printable(value.get<std::string>(), 100));
    } else if (key == "text" && value.is_string()) {
      wanted.text = printable(value.get<std::string>(), 100);
      has_text = true;
    } else {
      return bad(fmt::format("'{}' is none of do, quick, projector, resume, text, or has another kind of value",
                             printable(key)));
    }
  }
  if (has_text != (kind == "answer")) return bad("'text' belongs to 'answer', which needs it");
  if (kind == "answer") {
    wanted.kind = CalibrationRequest::Kind::kAnswer;
    if (json.size() != 2) return bad("'answer' takes 'text' and nothing else");
    return wanted;
  }
  if (kind == "start") {
    if (wanted.order.quick() && wanted.order.projector().empty())
      return bad("a quick calibration needs a projector's name");
    return wanted;
  }
  if (kind == "cancel") {
    wanted.kind = CalibrationRequest::Kind::kCancel;
  } else if (kind == "restore") {
    wanted.kind = CalibrationRequest::Kind::kRestore;
  } else if (kind == "place-cameras") {
    wanted.kind = CalibrationRequest::Kind::kPlaceCameras;
  } else {
    return bad("'do' must be start, answer, cancel, restore or place-cameras");
  }
  if (json.size() != 1) return bad(fmt::format("'{}' takes nothing else", kind));
  return wanted;
}

}  // namespace cyclorama::operations
