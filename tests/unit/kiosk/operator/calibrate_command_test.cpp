// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/calibrate_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <csignal>
#include <thread>

#include "tests/doubles/fake_calibrator.h"

namespace cyclorama::operations {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

wire::CalibrateProgress step(const std::string& sentence, double fraction) {
  wire::CalibrateProgress progress;
  progress.set_step(sentence);
  progress.set_fraction(fraction);
  return progress;
}

wire::CalibrateProgress end_of_it() {
  wire::CalibrateProgress progress = step("write", 1.0);
  wire::CalibrateDone* const done = progress.mutable_done();
  done->set_date("2026-11-22T13-05-00Z");
  done->add_remarks("the overlap of left and right is thin; move them nearer");
  done->add_remarks("evil\x1b[2J");
  done->set_registration_p95_px(0.314);
  done->set_report_path("/var/lib/cyclorama/calibration/report.html");
  return progress;
}

class CalibrateCommandTest : public ::testing::Test {
 protected:
  struct Outcome {
    Status status;
    std::string out;
    std::string err;
  };
  Outcome run(const std::vector<std::string>& arguments) {
    CLI::App app;
    CalibrateCommand command;
    command.add_to(&app);
    std::vector<const char*> argv{"cyclorama", "calibrate", "--calibrator"};
    const std::string address = calibrator_.address();
    argv.push_back(address.c_str());
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    app.parse(static_cast<int>(argv.size()), argv.data());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    Status status = command.run(stop_);
    const std::string out = ::testing::internal::GetCapturedStdout();
    return {std::move(status), out, ::testing::internal::GetCapturedStderr()};
  }

  StopSignal stop_;  // Must be first: it blocks the signals for all threads.
  FakeCalibrator calibrator_;
};

TEST_F(CalibrateCommandTest, prints_each_step_and_the_result_with_its_remarks) {
  calibrator_.messages = {step("show patterns", 0.0), step("show patterns", 0.3), step("show patterns", 0.31),
                          step("solve", 0.9), end_of_it()};
  const Outcome outcome = run({});
  ASSERT_TRUE(outcome.status) << outcome.status.error().message();
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("show patterns: 0 %\n"), HasSubstr("show patterns: 30 %\n"),
                                 HasSubstr("solve: 90 %\n"), HasSubstr("write: 100 %\n"), Not(HasSubstr("31 %"))));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("2026-11-22T13-05-00Z"), HasSubstr("0.31 px"), HasSubstr("report.html"),
                                 HasSubstr("- the overlap of left and right is thin"), Not(HasSubstr("\x1b"))));
  ASSERT_EQ(calibrator_.orders.size(), 1U);
  EXPECT_FALSE(calibrator_.orders[0].quick());
  EXPECT_FALSE(calibrator_.orders[0].resume());
}

TEST_F(CalibrateCommandTest, forwards_questions_to_the_terminal_and_sends_the_typed_answers) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(::pipe(ends), 0);
  const int before = ::dup(STDIN_FILENO);
  ::dup2(ends[0], STDIN_FILENO);
  ASSERT_EQ(::write(ends[1], "12.5\n", 5), 5);
  wire::CalibrateProgress question = step("turn the camera", 0.1);
  question.set_question("Turn the turntable to 12 degrees: ");
  calibrator_.messages = {question, step("solve", 0.9), end_of_it()};
  const Outcome outcome = run({});
  ::dup2(before, STDIN_FILENO);
  for (const int fd : {ends[0], ends[1], before}) ::close(fd);
  ASSERT_TRUE(outcome.status) << outcome.status.error().message();
  EXPECT_THAT(outcome.err, HasSubstr("Turn the turntable to 12 degrees"));
  EXPECT_EQ(calibrator_.answers, std::vector<std::string>{"12.5"});
}

TEST_F(CalibrateCommandTest, sends_the_requested_order) {
  calibrator_.messages = {end_of_it()};
  EXPECT_TRUE(run({"--quick", "left"}).status);
  EXPECT_TRUE(run({"--resume"}).status);
  ASSERT_EQ(calibrator_.orders.size(), 2U);
  EXPECT_TRUE(calibrator_.orders[0].quick());
  EXPECT_EQ(calibrator_.orders[0].projector(), "left");
  EXPECT_FALSE(calibrator_.orders[0].resume());
  EXPECT_TRUE(calibrator_.orders[1].resume());
  EXPECT_THROW(run({"--restore", "--resume"}), CLI::ParseError);
  EXPECT_THROW(run({"--restore", "--quick", "left"}), CLI::ParseError);
}

TEST_F(CalibrateCommandTest, cancels_the_call_on_a_signal) {
  calibrator_.messages = {step("show patterns", 0.2)};
  calibrator_.is_held = true;
  const std::jthread killer([this] {
    EXPECT_TRUE(calibrator_.wait_for_order());
    ::kill(::getpid(), SIGINT);
  });
  const Outcome outcome = run({});
  ASSERT_FALSE(outcome.status);
  EXPECT_THAT(outcome.status.error().message(), AllOf(HasSubstr("cancelled"), HasSubstr("--resume")));
  EXPECT_TRUE(calibrator_.wait_for_cancel());
  sigset_t interrupts;
  sigemptyset(&interrupts);
  sigaddset(&interrupts, SIGINT);
  const timespec now{};
  ::sigtimedwait(&interrupts, nullptr, &now);  // Removes a pending signal before the next test.
}

TEST_F(CalibrateCommandTest, fails_with_the_calibrators_own_message) {
  calibrator_.messages = {step("show patterns", 0.2)};
  calibrator_.end = {grpc::StatusCode::FAILED_PRECONDITION, "a calibration runs already; wait for its end"};
  const Outcome busy = run({});
  ASSERT_FALSE(busy.status);
  EXPECT_THAT(busy.status.error().message(), HasSubstr("runs already; wait"));
  EXPECT_EQ(busy.out, "");
  calibrator_.end = grpc::Status::OK;
  const Outcome nothing = run({});
  ASSERT_FALSE(nothing.status);
  EXPECT_EQ(nothing.status.error().code(), ErrorCode::kBadData);
}

TEST_F(CalibrateCommandTest, restores_the_previous_calibration) {
  calibrator_.restored_date.clear();
  const Outcome none = run({"--restore"});
  ASSERT_FALSE(none.status);
  EXPECT_EQ(none.status.error().code(), ErrorCode::kNotFound);
  calibrator_.restored_date = "2026-11-21T09-00-00Z";
  const Outcome restored = run({"--restore"});
  ASSERT_TRUE(restored.status) << restored.status.error().message();
  EXPECT_THAT(restored.out, HasSubstr("2026-11-21T09-00-00Z"));
  EXPECT_TRUE(calibrator_.orders.empty()) << "nothing is measured";
}

TEST_F(CalibrateCommandTest, reports_a_missing_calibrator) {
  CalibrateCommand command;
  command.calibrator = "[::1]:1";
  const Status status = command.run(stop_);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code(), ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace cyclorama::operations
