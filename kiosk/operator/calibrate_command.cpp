// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/calibrate_command.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <thread>
#include <utility>

#include "common/base/text.h"
#include "common/process/progress.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"

namespace cyclorama::operations {
namespace {

constexpr auto kLookAtStop = std::chrono::milliseconds(100);
constexpr auto kToAnswer = std::chrono::seconds(5);
constexpr auto kToRestore = std::chrono::seconds(30);
constexpr std::size_t kMaxRemarkLength = 600;

/// Cancels a call when the process receives a stop signal; active while the object exists.
class StoppedCall {
 public:
  StoppedCall(grpc::ClientContext* context, const StopSignal& stop)
      : watcher_([this, context, &stop](const std::stop_token& is_over) {
          while (!is_over.stop_requested()) {
            if (!stop.wait_until(SteadyClock().now() + kLookAtStop)) continue;
            was_stopped_ = true;
            return context->TryCancel();
          }
        }) {}
  [[nodiscard]] bool was_stopped() const { return was_stopped_; }

 private:
  std::atomic<bool> was_stopped_{false};
  std::jthread watcher_;
};

/// Shows questions on the terminal, and sends the typed answers; active while the object exists.
class TypedAnswers {
 public:
  explicit TypedAnswers(wire::Calibrator::Stub* stub)
      : stub_(*stub), reader_([this](const std::stop_token& is_over) { read(is_over); }) {}
  /// Shows a question; an empty text means that no question is open.
  void ask(const std::string& question) {
    if (!question.empty()) std::fprintf(stderr, "\n%s", printable(question, kMaxRemarkLength).c_str());
    is_asked_ = !question.empty();
  }

 private:
  void read(const std::stop_token& is_over) {
    std::string typed;
    while (!is_over.stop_requested()) {
      if (!is_asked_) {
        std::this_thread::sleep_for(kLookAtStop);
        continue;
      }
      pollfd entry{STDIN_FILENO, POLLIN, 0};
      if (::poll(&entry, 1, static_cast<int>(kLookAtStop.count())) <= 0) continue;
      char bytes[64];
      const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
      if (count <= 0) {
        std::fputs("(nobody can type here: answer on the operator's page)\n", stderr);
        return;
      }
      typed.append(bytes, static_cast<std::size_t>(count));
      const std::size_t end = typed.find_first_of("\r\n");
      if (end == std::string::npos) continue;
      send(typed.substr(0, end));
      typed.clear();
    }
  }
  void send(const std::string& text) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kToAnswer);
    wire::AnswerRequest order;
    order.set_text(text);
    wire::AnswerReply ignored;
    // An error means that the page has answered meanwhile, or that the calibration is over.
    static_cast<void>(stub_.Answer(&context, order, &ignored));
  }

  wire::Calibrator::Stub& stub_;
  std::atomic<bool> is_asked_{false};
  std::jthread reader_;
};

Result<wire::CalibrateDone> calibrate(wire::Calibrator::Stub* stub, const wire::CalibrateRequest& order,
                                      const StopSignal& stop) {
  grpc::ClientContext context;
  StoppedCall call(&context, stop);
  const auto stream = stub->Calibrate(&context, order);
  std::optional<wire::CalibrateDone> done;
  {
    Progress progress("calibrating");
    TypedAnswers answers(stub);
    std::string asked;
    wire::CalibrateProgress message;
    while (stream->Read(&message)) {
      progress.set_step(printable(message.step(), 50));
      progress.update(message.has_done() ? 1.0 : message.fraction());
      if (message.has_done()) done = message.done();
      if (message.question() != asked) answers.ask(asked = message.question());
    }
  }
  const grpc::Status end = finish_after_read(context, [&] { return stream->Finish(); });
  if (call.was_stopped() && !done) {
    return Error(ErrorCode::kUnavailable,
                 "cancelled: the show is as it was; what was photographed is kept for --resume");
  }
  if (!end.ok()) return from_grpc(end, "calibrating");
  if (!done) return Error(ErrorCode::kBadData, "calibrating: the calibrator ended without a result; look at its log");
  return *std::move(done);
}

Result<std::string> restore(wire::Calibrator::Stub* stub) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kToRestore);
  wire::RestoreReply answer;
  const grpc::Status status = stub->Restore(&context, wire::RestoreRequest(), &answer);
  if (!status.ok()) return from_grpc(status, "restoring the previous calibration");
  return printable(answer.date());
}

}  // namespace

void CalibrateCommand::add_to(CLI::App* app) {
  CLI::App& command = *app->add_subcommand(
      "calibrate",
      "Measure the wall: the heads show patterns for some minutes, then the projectors make one picture. "
      "Ctrl-C cancels it, and the show continues as before");
  auto* const quick_option =
      command.add_option("--quick", quick, "Measure only this projector, from one direction: ten seconds")
          ->type_name("PROJECTOR");
  auto* const resume =
      command.add_flag("--resume", is_resumed, "Continue with the photographs of a cancelled or failed calibration");
  command.add_flag("--restore", is_restored, "Restore the previous calibration without measuring")
      ->excludes(quick_option)
      ->excludes(resume);
  command.add_option("--calibrator", calibrator, "Address of cyclorama-calibrator")
      ->type_name("HOST:PORT")
      ->capture_default_str();
}

Status CalibrateCommand::run(const StopSignal& stop) const {
  TRY_ASSIGN(const std::shared_ptr<grpc::Channel> channel, make_channel(calibrator));
  const auto stub = wire::Calibrator::NewStub(channel);
  if (is_restored) {
    TRY_ASSIGN(const std::string date, restore(stub.get()));
    std::printf("the calibration of %s is in use again\n", date.c_str());
    return Done{};
  }
  wire::CalibrateRequest order;
  order.set_quick(quick.has_value());
  if (quick) order.set_projector(*quick);
  order.set_resume(is_resumed);
  TRY_ASSIGN(const wire::CalibrateDone done, calibrate(stub.get(), order, stop));
  std::fputs(calibration_report(done).c_str(), stdout);
  return Done{};
}

std::string calibration_report(const wire::CalibrateDone& done) {
  std::string text = fmt::format("calibrated at {}\n", printable(done.date()));
  text += fmt::format("  projectors agree within {:.2f} px on 95 % of where they meet\n", done.registration_p95_px());
  if (!done.report_path().empty())
    text += fmt::format("  report: {}\n", printable(done.report_path(), kMaxRemarkLength));
  if (done.remarks_size() > 0) text += "what could be better:\n";
  for (const std::string& remark : done.remarks()) text += fmt::format("  - {}\n", printable(remark, kMaxRemarkLength));
  return text;
}

}  // namespace cyclorama::operations
