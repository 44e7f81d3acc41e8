// SPDX-License-Identifier: Apache-2.0
// The V4L2 camera on a USB camera, for tests/image/usb_camera_guest_test.py: first process of a virtual machine, whose
// kernel drives the emulated camera (tests/image/usb_camera.py) with its own uvcvideo. Prints "usb: ..." for each
// picture that differs from the previous one, with the same fingerprint as usb_camera.py's fingerprint(), and when the
// camera is unplugged and present again. Then it becomes cyclorama-tracker with that camera.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <span>
#include <thread>

#include "drivers/devices/make_camera.h"
#include "tests/tools/first_process.h"

namespace cyclorama {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Number of times that the camera is plugged in; the host unplugs it after its pictures were seen.
constexpr int kPlugged = 2;

void say(const std::string& line) {
  fmt::print("usb: {}\n", line);
  std::fflush(stdout);
}

/// FNV-1a, 64 bits.
std::uint64_t fingerprint(std::span<const std::uint8_t> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3U;
  return hash;
}

/// Reads pictures until the camera is unplugged.
Status look(camera::Camera* camera, const Clock& clock) {
  TRY(camera->start());
  std::uint64_t shown = 0;
  int same = 0;
  for (;;) {
    const auto frame = camera->next_frame(clock.now() + seconds(5));
    if (!frame && frame.error().code() == ErrorCode::kTimedOut) continue;
    if (!frame) {
      say("gone: " + frame.error().message());
      return Done{};
    }
    const std::uint64_t now = fingerprint((*frame)->pixels.data());
    same = now == shown ? same + 1 : 0;
    shown = now;
    // Printed when the picture changes, and once more when it has stayed the same.
    if (same != 0 && same != 10) continue;
    say(fmt::format("picture {:016x} {}x{}, {} the same before it, exposure {:.1f} ms", now, (*frame)->pixels.width(),
                    (*frame)->pixels.height(), same, to_milliseconds((*frame)->exposure)));
  }
}

Status run(const Clock& clock) {
  std::string spec;
  for (int i = 0; i < kPlugged; ++i) {
    say("waits for a camera");
    std::vector<camera::ListedCamera> cameras;
    while ((cameras = devices::list_cameras()).empty()) std::this_thread::sleep_for(milliseconds(200));
    spec = cameras.front().spec;
    say(fmt::format("listed {} ({}), sends {}{}", spec, cameras.front().name, cameras.front().sends,
                    cameras.front().problem));
    TRY_ASSIGN(const std::unique_ptr<camera::Camera> camera, devices::make_camera(spec, clock));
    TRY(look(camera.get(), clock));
  }
  say("tracker starts");
  std::array<std::string, 4> words{"/bin/cyclorama-tracker", "--camera", spec, "--listen=unix:/tmp/tracker"};
  std::array<char*, 5> arguments{words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  ::execv(arguments[0], arguments.data());
  return Error::from_errno(words[0]);
}

}  // namespace
}  // namespace cyclorama

int main() {
  using namespace cyclorama;
  become_first_process([](const std::string&) { return ""; });
  const Status ended = run(SteadyClock());
  say("failed: " + ended.error().message());
  return 1;
}
