// SPDX-License-Identifier: Apache-2.0
// The service over gRPC, backed by a very small simulated museum.
#include "appliance/calibrator/calibrator_service.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <future>
#include <numbers>
#include <optional>
#include <thread>

#include "appliance/calibration/calibration_file.h"
#include "appliance/scan/simulated_devices.h"
#include "common/wire/channel.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/turntable/simulated_turntable.h"
#include "tests/doubles/fake_clock.h"

namespace cyclorama::calibrator {
namespace {

using ::testing::HasSubstr;

class CalibratorServiceTest : public ::testing::Test {
 protected:
  CalibratorServiceTest()
      : folder_(std::filesystem::path(::testing::TempDir()) / ("calibrator-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    simulated::PresetOptions options;
    options.projectors = 2;
    options.projector_width_px = 160;
    options.projector_height_px = 100;
    options.camera_megapixels = 0.08;
    preset_ = *simulated::make_preset("cylinder126", 1, options);
    museum_.emplace(*simulated::SimulatedMuseum::make(preset_.installation, preset_.truth));
    service_.emplace(
        preset_.installation, folder_, [this] { return open(); }, clock_, &inspection_);
    server_ = *WireServer::start("[::1]:0", {&*service_});
    stub_ = wire::Calibrator::NewStub(*make_channel("[::1]:" + std::to_string(server_->port())));
  }
  ~CalibratorServiceTest() override {
    service_->stop();
    server_->stop(std::chrono::seconds(5));
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Result<CalibrationDevices> open() {
    CalibrationDevices devices;
    devices.turntable = std::make_unique<simulated::SimulatedTurntable>(&*museum_);
    devices.camera = std::make_unique<scan::SimulatedScanCamera>(&*museum_, scan::PhotographColour::kGrey);
    devices.screen = std::make_unique<scan::SimulatedPatternScreen>(&*museum_);
    devices.settings.camera =
        scan::data_sheet_lens(devices.camera->width_px(), devices.camera->height_px(), 70.0 * std::numbers::pi / 180.0);
    return devices;
  }
  /// Cancels after `cancel_after` progress messages, or runs to the end.
  grpc::Status calibrate(const wire::CalibrateRequest& order, int cancel_after = 1 << 30) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    const auto reader = stub_->Calibrate(&context, order);
    progress_.clear();
    wire::CalibrateProgress message;
    while (reader->Read(&message)) {
      progress_.push_back(message);
      if (static_cast<int>(progress_.size()) >= cancel_after) context.TryCancel();
    }
    return reader->Finish();
  }

  const SteadyClock clock_;
  std::filesystem::path folder_;
  simulated::Preset preset_;
  std::optional<simulated::SimulatedMuseum> museum_;
  InspectionService inspection_{"calibrator"};
  std::optional<CalibratorService> service_;
  std::unique_ptr<WireServer> server_;
  std::unique_ptr<wire::Calibrator::Stub> stub_;
  std::vector<wire::CalibrateProgress> progress_;
};

TEST_F(CalibratorServiceTest, calibrates_reports_progress_and_restores_the_previous_calibration) {
  const auto done = calibrate({});
  ASSERT_TRUE(done.ok()) << done.error_message();
  ASSERT_GE(progress_.size(), 3u);
  for (std::size_t i = 1; i < progress_.size(); ++i) {
    EXPECT_GE(progress_[i].fraction(), progress_[i - 1].fraction());
    EXPECT_FALSE(progress_[i - 1].has_done());
  }
  ASSERT_TRUE(progress_.back().has_done());
  EXPECT_DOUBLE_EQ(progress_.back().fraction(), 1.0);
  const std::string date = progress_.back().done().date();
  EXPECT_EQ(calibration::read_calibration(folder_)->date, date);
  EXPECT_GT(progress_.back().done().registration_p95_px(), 0.0);
  EXPECT_TRUE(std::any_of(progress_.begin(), progress_.end(), [](const auto& p) { return !p.jpeg().empty(); }));
  EXPECT_THAT(inspection_.status().state(), HasSubstr("calibrated 2 projectors"));

  grpc::ClientContext nothing_before;
  wire::RestoreReply answer;
  EXPECT_EQ(stub_->Restore(&nothing_before, {}, &answer).error_code(), grpc::StatusCode::NOT_FOUND);
  // A second calibration with a later date.
  calibration::Calibration later = *calibration::read_calibration(folder_);
  later.date = "2999-01-01T00-00-00Z";
  ASSERT_TRUE(calibration::save_calibration(folder_, later).has_value());
  grpc::ClientContext context;
  const auto restored = stub_->Restore(&context, {}, &answer);
  ASSERT_TRUE(restored.ok()) << restored.error_message();
  EXPECT_EQ(answer.date(), date);
  EXPECT_EQ(calibration::read_calibration(folder_)->date, date);
}

TEST_F(CalibratorServiceTest, realigns_a_displaced_projector) {
  ASSERT_TRUE(calibrate({}).ok());
  const calibration::Calibration before = *calibration::read_calibration(folder_);
  auto& stands = preset_.truth.projectors[1].T_room_projector;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY()));
  stands = {turn * stands.rotation(), stands.translation()};
  museum_.emplace(*simulated::SimulatedMuseum::make(preset_.installation, preset_.truth));

  wire::CalibrateRequest quick;
  quick.set_quick(true);
  quick.set_projector(preset_.installation.projectors[1].name);
  const auto done = calibrate(quick);
  ASSERT_TRUE(done.ok()) << done.error_message();
  ASSERT_TRUE(progress_.back().has_done());
  const auto after = calibration::read_calibration(folder_);
  ASSERT_TRUE(after) << after.error().message();
  EXPECT_EQ(after->date, progress_.back().done().date());
  EXPECT_TRUE(after->projectors[0].is_previous);
  const auto turned_deg = [&](std::size_t p) {
    const calibration::MeasuredMap& was = before.projectors[p].map;
    const calibration::MeasuredMap& is = after->projectors[p].map;
    const std::size_t middle = was.directions.size() / 2;
    return std::acos(std::min(1.0, was.directions[middle].dot(is.directions[middle]))) * 180.0 / std::numbers::pi;
  };
  EXPECT_EQ(turned_deg(0), 0.0);
  EXPECT_NEAR(turned_deg(1), 2.0, 1.0) << "an eye elsewhere sees another angle";
}

/// A turntable that a person turns and that the museum follows.
class HandTurnedTurntable final : public turntable::Turntable {
 public:
  HandTurnedTurntable(TurntablePrompt* prompt, simulated::SimulatedMuseum* museum)
      : turntable::Turntable({-3.0, 3.0}), prompt_(*prompt), museum_(*museum) {}
  [[nodiscard]] const std::string& id() const override { return id_; }

 private:
  Status move_home() override { return move_to(0.0); }
  Status move_to(double angle_rad) override {
    TRY_ASSIGN(const std::string answer, prompt_.ask("turn it", std::chrono::minutes(1)));
    if (answer != "") return Error(ErrorCode::kUnavailable, "the operator has stopped");
    museum_.turn_to(angle_rad);
    return Done{};
  }
  Result<double> ask_angle() override { return museum_.turntable_angle_rad(); }
  const std::string id_ = "by hand";
  TurntablePrompt& prompt_;
  simulated::SimulatedMuseum& museum_;
};

TEST_F(CalibratorServiceTest, asks_the_client_to_turn_the_turntable) {
  TurntablePrompt prompt;
  CalibratorService service(
      preset_.installation, folder_,
      [&]() -> Result<CalibrationDevices> {
        TRY_ASSIGN(CalibrationDevices devices, open());
        devices.turntable = std::make_unique<HandTurnedTurntable>(&prompt, &*museum_);
        return devices;
      },
      clock_, &inspection_);
  service.set_prompt(&prompt);
  const auto server = *WireServer::start("[::1]:0", {&service});
  const auto stub = wire::Calibrator::NewStub(*make_channel("[::1]:" + std::to_string(server->port())));
  const auto answered = [&](const std::string& text) {
    grpc::ClientContext context;
    wire::AnswerRequest order;
    order.set_text(text);
    wire::AnswerReply reply;
    return stub->Answer(&context, order, &reply).error_code();
  };
  EXPECT_EQ(answered(""), grpc::StatusCode::FAILED_PRECONDITION);
  grpc::ClientContext context;
  const auto reader = stub->Calibrate(&context, {});
  wire::CalibrateProgress message;
  int questions = 0;
  // Answers for home and the first direction; then the operator gives up.
  while (reader->Read(&message)) {
    if (message.question().empty()) continue;
    EXPECT_EQ(message.question(), "turn it");
    EXPECT_EQ(answered(++questions < 3 ? "" : "q"), grpc::StatusCode::OK);
  }
  EXPECT_EQ(questions, 3);
  const auto end = reader->Finish();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_THAT(end.error_message(), HasSubstr("has stopped"));
  service.stop();
  server->stop(std::chrono::seconds(5));
}

TEST_F(CalibratorServiceTest, leaves_no_calibration_when_cancelled_and_can_resume) {
  const auto cancelled = calibrate({}, 3);
  EXPECT_EQ(cancelled.error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "calibration.json"));
  wire::CalibrateRequest resume;
  resume.set_resume(true);
  // The previous call may take one more photograph before it ends.
  grpc::Status resumed;
  for (int i = 0; i < 100; ++i) {
    resumed = calibrate(resume);
    if (resumed.error_code() != grpc::StatusCode::FAILED_PRECONDITION) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_TRUE(resumed.ok()) << resumed.error_message();
  EXPECT_TRUE(std::filesystem::exists(folder_ / "calibration.json"));
}

TEST_F(CalibratorServiceTest, runs_one_calibration_at_a_time) {
  grpc::ClientContext context;
  const auto first = stub_->Calibrate(&context, {});
  wire::CalibrateProgress message;
  ASSERT_TRUE(first->Read(&message));
  const auto second = calibrate({});
  EXPECT_EQ(second.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(second.error_message(), HasSubstr("runs already"));
  context.TryCancel();
  while (first->Read(&message)) {
  }
  EXPECT_EQ(first->Finish().error_code(), grpc::StatusCode::CANCELLED);
}

TEST_F(CalibratorServiceTest, reports_that_a_calibration_whose_device_hangs_does_not_move_on) {
  FakeClock clock;
  std::promise<void> opening;
  std::promise<void> hang;
  CalibratorService service(
      preset_.installation, folder_,
      [&]() -> Result<CalibrationDevices> {
        opening.set_value();
        hang.get_future().wait();
        return Error(ErrorCode::kUnavailable, "no camera");
      },
      clock, &inspection_);
  const auto server = *WireServer::start("[::1]:0", {&service});
  const auto stub = wire::Calibrator::NewStub(*make_channel("[::1]:" + std::to_string(server->port())));
  clock.advance(std::chrono::hours(10));
  EXPECT_TRUE(service.moves_on()) << "nothing is to be done";
  grpc::ClientContext context;
  const auto reader = stub->Calibrate(&context, {});
  opening.get_future().wait();
  EXPECT_TRUE(service.moves_on());
  clock.advance(std::chrono::minutes(31));
  EXPECT_FALSE(service.moves_on());
  hang.set_value();
  wire::CalibrateProgress message;
  while (reader->Read(&message)) {
  }
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_TRUE(service.moves_on());
  service.stop();
  server->stop(std::chrono::seconds(5));
}

TEST_F(CalibratorServiceTest, refuses_to_realign_a_projector_without_a_calibration) {
  wire::CalibrateRequest quick;
  quick.set_quick(true);
  EXPECT_EQ(calibrate(quick).error_code(), grpc::StatusCode::INVALID_ARGUMENT) << "which one?";
  quick.set_projector(preset_.installation.projectors[0].name);
  const auto nothing_before = calibrate(quick);
  EXPECT_EQ(nothing_before.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(nothing_before.error_message(), HasSubstr("calibrate all projectors"));
  quick.set_resume(true);
  EXPECT_EQ(calibrate(quick).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(CalibratorServiceTest, has_nothing_to_resume_at_first) {
  wire::CalibrateRequest resume;
  resume.set_resume(true);
  const auto refused = calibrate(resume);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(refused.error_message(), HasSubstr("nothing to go on with"));
}

}  // namespace
}  // namespace cyclorama::calibrator
