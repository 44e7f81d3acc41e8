// SPDX-License-Identifier: Apache-2.0
// Pictures through libcamera itself, for tests/image/camera_test.py: first process of a virtual machine, whose virtual
// camera shows one photo repeatedly. Prints "libcamera: ..." per step, and at the end "libcamera: ok" or "failed: ...".
#include <fmt/format.h>
#include <sys/reboot.h>

#include <numeric>
#include <set>
#include <thread>

#include "common/base/percentiles.h"
#include "drivers/camera/libcamera/libcamera_camera.h"
#include "tests/tools/first_process.h"

namespace cyclorama {
namespace {

using std::chrono::seconds;

constexpr int kPictures = 60;

void say(const std::string& line) {
  fmt::print("libcamera: {}\n", line);
  std::fflush(stdout);
}

double mean_of(const GreyImage& picture) {
  const double sum = std::accumulate(picture.data().begin(), picture.data().end(), 0.0);
  return sum / static_cast<double>(picture.data().size());
}

std::size_t open_files() {
  const auto begin = std::filesystem::directory_iterator("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin, std::filesystem::directory_iterator{}));
}

Status look(camera::Camera* camera, const Clock& clock) {
  TRY(camera->start());
  Percentiles latency_ms;
  std::set<double> means;
  std::uint64_t first = 0;
  std::shared_ptr<const camera::CameraFrame> frame;
  for (int i = 0; i < kPictures; ++i) {
    const std::shared_ptr<const camera::CameraFrame> last = frame;
    TRY_ASSIGN(frame, camera->next_frame(clock.now() + seconds(5)));
    latency_ms.add(to_milliseconds(clock.now() - frame->captured_at));
    means.insert(mean_of(frame->pixels));
    if (i == 0) first = frame->sequence;
    if (last && (frame->sequence <= last->sequence || frame->captured_at < last->captured_at)) {
      return Error(ErrorCode::kBadData, "pictures come in the wrong order");
    }
  }
  say(fmt::format(
      "{}: {} pictures of {}x{}, {} dropped, mean grey {:.1f} to {:.1f}; stamp to delivery p50 {:.2f} ms, p95 {:.2f} "
      "ms",
      camera->id(), kPictures, frame->pixels.width(), frame->pixels.height(), frame->sequence - first + 1 - kPictures,
      *means.begin(), *means.rbegin(), latency_ms.at(0.5), latency_ms.at(0.95)));
  // A late reader: of the pictures finished meanwhile, all but the newest are dropped.
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  TRY_ASSIGN(const auto late, camera->next_frame(clock.now() + seconds(5)));
  say(fmt::format("after a pause of 400 ms: {} later, {:.1f} ms old", late->sequence - frame->sequence,
                  to_milliseconds(clock.now() - late->captured_at)));
  camera->stop();
  if (camera->next_frame(clock.now())) return Error(ErrorCode::kBadData, "a stopped camera delivers");
  return Done{};
}

Status run() {
  const SteadyClock clock;
  const std::vector<camera::ListedCamera> cameras = camera::list_libcamera_cameras();
  for (const camera::ListedCamera& camera : cameras) say(fmt::format("listed {} ({})", camera.spec, camera.name));
  if (cameras.empty()) return Error(ErrorCode::kNotFound, "libcamera shows no camera");
  std::size_t files = 0;
  for (int round = 0; round < 4; ++round) {
    {
      TRY_ASSIGN(const std::unique_ptr<camera::Camera> camera, camera::open_libcamera_camera("", {}, clock));
      TRY(look(camera.get(), clock));
      TRY(look(camera.get(), clock));
      TRY(camera->start());
      const auto second = camera::open_libcamera_camera("", {}, clock);
      if (second && (*second)->start()) return Error(ErrorCode::kBadData, "two stream at once");
      if (round == 0 && second) say("second: " + (*second)->start().error().message());
    }
    if (round == 1) files = open_files();
    if (round > 1 && open_files() != files) return Error(ErrorCode::kBadData, "files are left open");
  }
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main() {
  using namespace cyclorama;
  const bool is_first = ::getpid() == 1;
  if (is_first) become_first_process([](const std::string&) { return ""; });
  const auto ended = run();
  say(ended ? "ok" : "failed: " + ended.error().message());
  if (is_first) ::reboot(RB_POWER_OFF);
  return ended ? 0 : 1;
}
