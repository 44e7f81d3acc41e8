// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "appliance/tags/tag_detector.h"
#include "drivers/camera/file/file_camera.h"
#include "tests/doubles/fake_clock.h"

/// Any bytes behind a file camera (a photo or a video) are pictures or an Error, and the detector survives the
/// pictures.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  static const int file = ::memfd_create("fuzz", 0);
  static auto detector = tags::TagDetector::create({});
  if (file < 0 || !detector || ::ftruncate(file, 0) != 0) std::abort();
  if (size > 0 && ::pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
  const FakeClock clock;
  auto camera = camera::FileCamera::open("/proc/self/fd/" + std::to_string(file), {}, clock);
  if (!camera) return 0;
  if (!(*camera)->start()) std::abort();
  for (int i = 0; i < 3; ++i) {
    const auto frame = (*camera)->next_frame(clock.now() + std::chrono::seconds(200));
    if (!frame) return 0;
    if ((*frame)->pixels.data().size() < 1'000'000) static_cast<void>(detector->detect((*frame)->pixels).has_value());
  }
  return 0;
}
