// SPDX-License-Identifier: Apache-2.0
/// cyclorama-hand: everything that steers without a camera. Gamepads, keyboards and 3D mice give commands; poses that
/// other trackers send by OSC or VRPN replace those of Cyclorama's tracker.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <grpcpp/client_context.h>

#include <optional>
#include <string>

#include "appliance/hand/pose_listener.h"
#include "appliance/tracker/tour_link.h"
#include "common/base/file.h"
#include "common/language/marked_texts.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "common/wire/channel.h"
#include "common/wire/inspection_service.h"
#include "common/wire/museum.grpc.pb.h"
#include "drivers/input/evdev/evdev_device.h"

namespace cyclorama::hand {
namespace {

constexpr Duration kRound = std::chrono::milliseconds(10);
constexpr Duration kSteerEvery = std::chrono::milliseconds(50);  // The tour holds a command for 300 ms.
constexpr std::chrono::milliseconds kSteerDeadline(150);
constexpr std::chrono::milliseconds kStopDeadline(1000);  // A press of a button is not repeated, as steering is.
constexpr Duration kReportPeriod = std::chrono::milliseconds(500);

struct Options {
  std::string tour = "[::1]:7403";
  std::string listen = "[::1]:7409";
  std::string devices = "/dev/input";
  std::string osc;
  std::string vrpn;
  std::string vrpn_device;
  std::string axes = "camera";
  std::string help_pressed;
};

void add_options(CLI::App& app, Options* options) {
  app.add_option("--tour", options->tour, "Where the tour listens")->type_name("HOST:PORT")->capture_default_str();
  app.add_option("--listen", options->listen, "Where to show live state to the operator")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--devices", options->devices, "Folder of the kernel's input devices; empty: none")
      ->type_name("FOLDER")
      ->capture_default_str();
  app.add_option("--osc", options->osc,
                 "Listen here for /cyclorama/pose, /cyclorama/lost, /cyclorama/steer, /cyclorama/stop and "
                 "/cyclorama/captions")
      ->type_name("HOST:PORT");
  app.add_option("--vrpn", options->vrpn, "Listen here for a VRPN tracker's datagrams")->type_name("HOST:PORT");
  app.add_option("--vrpn-device", options->vrpn_device, "Follow only the VRPN tracker of this name");
  app.add_option("--help-pressed", options->help_pressed,
                 "Write this file when Help or F1 is pressed; the display then shows how to reach the operator page")
      ->type_name("FILE");
  app.add_option("--axes", options->axes,
                 "Axes of those poses: 'camera', as cyclorama-tracker's, or 'room', x to the visitor's right, y up")
      ->check(CLI::IsMember({"camera", "room"}))
      ->capture_default_str();
}

/// Sends commands to the tour while there are any, and once more when they end.
class SteerLink {
 public:
  static Result<SteerLink> open(const std::string& address) {
    TRY_ASSIGN(std::shared_ptr<grpc::Channel> channel, make_channel(address));
    return SteerLink(std::move(channel));
  }
  /// Sends `command` if it is due. Blocks for at most kSteerDeadline.
  void tell(const input::InputCommand& command, TimePoint now) {
    if (command.is_rest() && rested_) return;
    if (command == told_ && now - told_at_ < kSteerEvery) return;
    wire::SteerRequest request;
    request.set_forward(command.forward);
    request.set_right(command.right);
    request.set_turn(command.turn);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kSteerDeadline);
    wire::SteerReply reply;
    reached_ = stub_->Steer(&context, request, &reply).ok();
    told_ = command;
    told_at_ = now;
    rested_ = command.is_rest();  // If a rest command is lost, the tour stops by itself 300 ms later.
  }
  /// Requests a stop once. Blocks for at most kStopDeadline. A refusal, such as of an unknown name, counts as reached.
  void go_to(const tracker::OscStop& stop) {
    wire::GoToStopRequest request;
    if (const auto* const name = std::get_if<std::string>(&stop)) request.set_name(*name);
    if (const auto* const step = std::get_if<int>(&stop)) request.set_step(*step);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kStopDeadline);
    wire::GoToStopReply reply;
    note(stub_->GoToStop(&context, request, &reply));
  }
  /// Requests languages on the wall once; otherwise like go_to().
  void write(const tracker::OscCaptions& captions) {
    wire::SetCaptionsRequest request;
    request.set_next(!captions.languages);
    if (captions.languages) request.mutable_languages()->Assign(captions.languages->begin(), captions.languages->end());
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kStopDeadline);
    wire::SetCaptionsReply reply;
    note(stub_->SetCaptions(&context, request, &reply));
  }
  [[nodiscard]] bool reached() const { return reached_; }

 private:
  explicit SteerLink(std::shared_ptr<grpc::Channel> channel)
      : channel_(std::move(channel)), stub_(wire::Tour::NewStub(channel_)) {}
  void note(const grpc::Status& status) {
    const grpc::StatusCode code = status.error_code();
    reached_ = code != grpc::StatusCode::UNAVAILABLE && code != grpc::StatusCode::DEADLINE_EXCEEDED;
  }
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<wire::Tour::Stub> stub_;
  input::InputCommand told_;
  TimePoint told_at_{};
  bool rested_ = true;
  bool reached_ = true;
};

wire::TrackedPose to_wire_pose(const tracker::PoseReport& report, tracker::TrackerAxes axes, TimePoint arrived_at) {
  wire::TrackedPose pose;
  pose.set_camera("another tracker");
  pose.set_sequence(report.sequence);
  pose.set_shutter_ns(to_nanoseconds(arrived_at));  // The sender's clock has no meaning here.
  pose.set_tag(static_cast<std::uint32_t>(report.sensor));
  const auto T_camera_tag = tracker::pose_of(report, axes);
  pose.set_found(T_camera_tag.has_value());
  if (!T_camera_tag) return pose;
  const Eigen::Vector3d& position = T_camera_tag->translation();
  pose.mutable_position_m()->set_x(position.x());
  pose.mutable_position_m()->set_y(position.y());
  pose.mutable_position_m()->set_z(position.z());
  const Eigen::Quaterniond& rotation = T_camera_tag->rotation();
  pose.set_rotation_w(rotation.w());
  pose.set_rotation_x(rotation.x());
  pose.set_rotation_y(rotation.y());
  pose.set_rotation_z(rotation.z());
  return pose;
}

Status run(const Options& options, const StopSignal& stop) {
  const SteadyClock clock;
  InspectionService inspection("hand");
  TRY_ASSIGN(const std::unique_ptr<WireServer> server, WireServer::start(options.listen, {&inspection}));
  TRY_ASSIGN(PoseListener listener, PoseListener::open(options.osc, options.vrpn, options.vrpn_device));
  TRY_ASSIGN(SteerLink steer, SteerLink::open(options.tour));
  const bool hears_poses = !options.osc.empty() || !options.vrpn.empty();
  std::unique_ptr<tracker::TourLink> poses;
  if (hears_poses) {
    TRY_ASSIGN(poses, tracker::TourLink::open(options.tour));
  }
  input::InputWatch inputs(options.devices.empty()
                               ? input::InputDevices{[] { return std::vector<std::string>{}; }, input::open_evdev}
                               : input::evdev_devices(options.devices));
  const tracker::TrackerAxes axes =
      options.axes == "room" ? tracker::TrackerAxes::kRoom : tracker::TrackerAxes::kCamera;
  Notify notify;
  notify.ready();
  TimePoint said_at{};
  input::InputCommand osc_command;
  TimePoint osc_command_at{};
  std::uint64_t heard_poses = 0;
  std::string said;
  do {
    const TimePoint now = clock.now();
    const ReceivedPoses heard = listener.take(now);
    for (const tracker::PoseReport& report : heard.poses) poses->send(to_wire_pose(report, axes, clock.now()));
    heard_poses += heard.poses.size();
    if (heard.steer) {
      osc_command = {(*heard.steer)[0], (*heard.steer)[1], (*heard.steer)[2]};
      osc_command_at = now;
    }
    inputs.update(now);
    if (heard.stop) steer.go_to(*heard.stop);
    if (heard.captions) steer.write(*heard.captions);
    if (inputs.take_languages() > 0) steer.write({});
    if (const int steps = inputs.take_steps(); steps != 0) steer.go_to(steps > 0 ? 1 : -1);
    if (inputs.take_help() && !options.help_pressed.empty()) {
      // The display reads only the file's time; the text is for people.
      const Status written = write_file_atomically(options.help_pressed, std::string_view("Help was pressed.\n"));
      if (!written) log(LogLevel::kError, written.error().message());
    }
    input::InputCommand command = inputs.command(now);
    // As with keys, a command ends once its sender has been silent for a while.
    if (command.is_rest() && now - osc_command_at < std::chrono::milliseconds(300)) command = osc_command;
    steer.tell(command, now);
    if (now - said_at < kReportPeriod) continue;
    said_at = now;
    notify.keep_alive(now);
    const auto sentences = inputs.sentences();
    std::string sentence = sentences.empty() ? translatable("No gamepad, keyboard or 3D mouse is plugged in")
                                             : fmt::format("{}", fmt::join(sentences, ", "));
    if (hears_poses) sentence += fmt::format("; {} poses heard from other trackers", heard_poses > 0 ? "some" : "no");
    if (!steer.reached()) sentence += "; " + fmt::format(translatable("the tour at {} does not answer"), options.tour);
    inspection.set_state(sentence + ".", steer.reached());
    inspection.set_gauge("devices", static_cast<double>(inputs.open_count()));
    inspection.set_gauge("poses_heard", static_cast<double>(heard_poses));
    inspection.set_gauge("datagrams_refused", static_cast<double>(listener.refused()));
    if (sentence == said) continue;
    said = sentence;
    notify.status(sentence);
    log(LogLevel::kInfo, sentence);
  } while (!stop.wait_until(clock.now() + kRound));
  notify.stopping();
  server->stop(std::chrono::milliseconds(200));
  return Done{};
}

}  // namespace
}  // namespace cyclorama::hand

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-hand",
                             "Steers the tour by gamepad, keyboard or 3D mouse, and by poses that other trackers send "
                             "(OSC, VRPN); leads to the tour's stops by their buttons or OSC.");
  cyclorama::hand::Options options;
  cyclorama::hand::add_options(program.options(), &options);
  return program.run(argc, argv,
                     [&](const cyclorama::StopSignal& stop) { return cyclorama::hand::run(options, stop); });
}
