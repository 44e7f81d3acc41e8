// SPDX-License-Identifier: Apache-2.0
// Rendered pictures through a real V4L2 device, the kernel's vivid, for tests/image/camera_test.py. First process of a
// virtual machine: loads the driver, connects its output to its input, checks what the V4L2 camera reads, provokes
// every fault that the driver can simulate, and finally runs cyclorama-tracker while the camera is unplugged and
// plugged in again. Prints a line "camera: ..." for each step, and at the end "camera: ok" or "camera: failed: ...".
#include <fmt/format.h>
#include <signal.h>
#include <sys/reboot.h>
#include <sys/wait.h>

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <thread>

#include "appliance/tags/tag_detector.h"
#include "common/base/percentiles.h"
#include "common/room/pinhole.h"
#include "drivers/devices/make_camera.h"
#include "drivers/simulated/camera/simulated_camera.h"
#include "tests/tools/first_process.h"
#include "tests/tools/vivid.h"

namespace cyclorama {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr const char* kPort = "platform:vivid-000";
constexpr int kPictures = 120;

void say(const std::string& line) {
  fmt::print("camera: {}\n", line);
  std::fflush(stdout);
}

Error failure(std::string what) { return {ErrorCode::kBadData, std::move(what)}; }

/// A hand with the standard wand, 1 m away and turned by 12°.
simulated::SimulatedView the_view() {
  simulated::Simulation simulation;
  simulated::KeyPose key;
  key.position_m = {0.05, 0.02, 1.0};
  key.yaw_rad = 12.0 * std::numbers::pi / 180.0;
  simulation.path = *simulated::HandPath::make({key}, std::nullopt);
  return simulated::SimulatedView(std::move(simulation));
}

Result<std::unique_ptr<camera::Camera>> started(const std::string& options, const Clock& clock) {
  TRY_ASSIGN(std::unique_ptr<camera::Camera> camera,
             devices::make_camera(fmt::format("v4l2:{}{}", kPort, options), clock));
  TRY(camera->start());
  return camera;
}

/// Waits for the first picture that equals the sent one bit for bit; earlier ones may be the driver's own.
Status await_picture(camera::Camera* camera, const GreyImage& sent, const Clock& clock) {
  int others = 0;
  for (const TimePoint until = clock.now() + seconds(20); clock.now() < until; ++others) {
    TRY_ASSIGN(const auto frame, camera->next_frame(clock.now() + seconds(5)));
    if (frame->pixels == sent) return Done{};
  }
  return failure(fmt::format("of {} pictures none was the one that was sent", others));
}

Status look(const std::string& options, const GreyImage& sent, const Clock& clock) {
  TRY_ASSIGN(const std::unique_ptr<camera::Camera> camera, started(options, clock));
  TRY(await_picture(camera.get(), sent, clock));
  TRY_ASSIGN(tags::TagDetector detector, tags::TagDetector::create({}));
  Percentiles latency_ms;
  Percentiles detect_ms;
  int same = 0;
  int found = 0;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  for (int i = 0; i < kPictures; ++i) {
    TRY_ASSIGN(const auto frame, camera->next_frame(clock.now() + seconds(5)));
    const TimePoint delivered_at = clock.now();
    latency_ms.add(to_milliseconds(delivered_at - frame->captured_at));
    same += frame->pixels == sent ? 1 : 0;
    if (i == 0) first = frame->sequence;
    last = frame->sequence;
    // Every tenth picture, since detection in a virtual machine without acceleration is slower than the driver.
    if (i % 10 != 0) continue;
    TRY_ASSIGN(const std::vector<tags::TagDetection> tags, detector.detect(frame->pixels));
    detect_ms.add(to_milliseconds(clock.now() - delivered_at));
    found += tags.size() == 3 ? 1 : 0;  // The standard wand has three.
  }
  say(fmt::format(
      "pictures {}: {} of {} bit for bit, tag found in {} of {}, {} dropped; stamp to delivery p50 {:.2f} ms, "
      "p95 {:.2f} ms; detection p50 {:.1f} ms",
      options.empty() ? "mapped" : options, same, kPictures, found, kPictures / 10, last - first + 1 - kPictures,
      latency_ms.at(0.5), latency_ms.at(0.95), detect_ms.at(0.5)));
  if (same != kPictures || found != kPictures / 10) return failure("not every picture was the one that was sent");
  return Done{};
}

Status check_another_program(const Clock& clock) {
  TRY_ASSIGN(const std::unique_ptr<camera::Camera> first, started("", clock));
  const auto second = started("", clock);
  if (second || second.error().code() != ErrorCode::kBusy) return failure("two programs stream at once");
  say("busy: " + second.error().message());
  return Done{};
}

/// Checks the effect of a driver's fault: an Error, or none within a second.
Status check_fault(const std::string& control, const GreyImage& sent, const Clock& clock) {
  TRY_ASSIGN(const std::unique_ptr<camera::Camera> camera, started("", clock));
  TRY(await_picture(camera.get(), sent, clock));
  TRY(VividCable::set_control(control, 1));
  std::string said = "not noticed";
  for (const TimePoint until = clock.now() + seconds(1); clock.now() < until;) {
    const auto frame = camera->next_frame(clock.now() + milliseconds(500));
    if (frame) continue;
    said = frame.error().message();
    if (frame.error().code() == ErrorCode::kUnavailable) break;
  }
  say(fmt::format("fault '{}': {}", control, said));
  return Done{};
}

Status check_lost_signal(const GreyImage& sent, const Clock& clock) {
  TRY_ASSIGN(std::unique_ptr<camera::Camera> camera, started("", clock));
  TRY(await_picture(camera.get(), sent, clock));
  constexpr const char* kMode = "DV Timings Signal Mode";
  TRY(VividCable::set_control(kMode, 1));
  std::string said = "no word";
  for (const TimePoint until = clock.now() + seconds(5); clock.now() < until;) {
    const auto frame = camera->next_frame(clock.now() + milliseconds(500));
    if (frame) continue;
    said = frame.error().message();
    if (frame.error().code() == ErrorCode::kUnavailable) break;
  }
  camera.reset();
  const auto dark = started("", clock);
  say(fmt::format("signal lost: {}; then: {}", said, dark ? "starts" : dark.error().message()));
  if (dark) return failure("a camera starts without a signal");
  TRY(VividCable::set_control(kMode, 0));
  TRY_ASSIGN(camera, started("", clock));
  return await_picture(camera.get(), sent, clock);
}

Status write_text(const char* path, std::string_view text) {
  std::ofstream file(path);
  file << text;
  file.flush();
  if (!file) return Error::from_errno(path);
  return Done{};
}

/// Runs cyclorama-tracker, with its output on the console.
class TrackerProcess {
 public:
  TrackerProcess() : id_(::fork()) {
    if (id_ != 0) return;
    std::array<std::string, 4> words{"/bin/cyclorama-tracker", "--camera", fmt::format("v4l2:{}", kPort),
                                     "--listen=unix:/tmp/tracker"};
    std::array<char*, 5> arguments{words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ~TrackerProcess() {
    ::kill(id_, SIGTERM);
    ::waitpid(id_, nullptr, 0);
  }

 private:
  pid_t id_;
};

/// Unplugs and replugs the camera while the tracker runs; the host reads the tracker's output meanwhile.
Status check_tracker(const GreyImage& sent) {
  const auto wait = [](seconds time) { std::this_thread::sleep_for(time); };
  TRY_ASSIGN(std::unique_ptr<VividCable> cable, VividCable::plug(sent));
  say("tracker starts");
  const TrackerProcess tracker;
  wait(seconds(25));
  say("unplugged");
  cable.reset();
  TRY(write_text("/sys/bus/platform/drivers/vivid/unbind", "vivid.0"));
  wait(seconds(8));
  say("plugged in again");
  TRY(write_text("/sys/bus/platform/drivers/vivid/bind", "vivid.0"));
  wait(seconds(1));
  TRY_ASSIGN(cable, VividCable::plug(sent));
  wait(seconds(25));
  say("tracker ends");
  return Done{};
}

Status run() {
  const SteadyClock clock;
  const GreyImage sent = the_view().picture(0);
  for (const camera::ListedCamera& camera : devices::list_cameras()) {
    say(fmt::format("listed {} ({}, {}), sends {}{}", camera.spec, camera.name, camera.path, camera.sends,
                    camera.problem));
  }
  {
    TRY_ASSIGN(const std::unique_ptr<VividCable> cable, VividCable::plug(sent));
    TRY(look("", sent, clock));
    TRY(look("?memory=dma_buf", sent, clock));
    TRY(check_another_program(clock));
    TRY(check_fault("Inject V4L2_BUF_FLAG_ERROR", sent, clock));
    TRY(check_fault("Inject VIDIOC_QBUF Error", sent, clock));
    TRY(check_fault("Inject Fatal Streaming Error", sent, clock));
  }
  {
    TRY_ASSIGN(const std::unique_ptr<VividCable> cable, VividCable::plug(sent));
    TRY(check_lost_signal(sent, clock));
  }
  return check_tracker(sent);
}

}  // namespace
}  // namespace cyclorama

int main() {
  using namespace cyclorama;
  const bool is_first = ::getpid() == 1;
  if (is_first) {
    become_first_process([](const std::string& name) { return name == "vivid" ? kVividParameters : ""; });
  }
  const auto ended = run();
  say(ended ? "ok" : "failed: " + ended.error().message());
  if (is_first) ::reboot(RB_POWER_OFF);
  return ended ? 0 : 1;
}
