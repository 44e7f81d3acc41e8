// SPDX-License-Identifier: Apache-2.0
// Cost of reading a camera's picture, per layout and size: our share of the time from the shutter's end to the
// delivered frame. Prints a table; the last line is JSON. Usage: read_main [--quick]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "common/base/clock.h"
#include "common/base/percentiles.h"
#include "drivers/camera/raw_picture.h"

namespace cyclorama {
namespace {

struct Case {
  camera::PixelLayout layout;
  int width;
  int height;
};

/// Edges and smooth areas, as in a photograph of a room.
RgbImage room(int width, int height) {
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_light = (x / 24 + y / 24) % 2 == 0 && x > width / 3 && x < 2 * width / 3;
      std::fill_n(picture.at(x, y), 3, static_cast<std::uint8_t>(is_light ? 220 : 40 + (x + 2 * y) % 90));
    }
  }
  return picture;
}

void measure(const Case& wanted, int pictures, std::string* ret_json) {
  const auto pixels = static_cast<std::size_t>(wanted.width) * static_cast<std::size_t>(wanted.height);
  std::vector<std::byte> bytes(pixels * 2, std::byte{77});
  if (wanted.layout == camera::PixelLayout::kJpeg) {
    JpegEncoder encoder;
    bytes = *encoder.encode(room(wanted.width, wanted.height), {85, true});
  }
  const std::size_t row = static_cast<std::size_t>(wanted.width) * camera::bytes_per_pixel(wanted.layout);
  JpegDecoder jpeg;
  Percentiles ms;
  const SteadyClock clock;
  for (int i = 0; i < pictures; ++i) {
    const TimePoint begun_at = clock.now();
    GreyImage grey;  // A new picture each time, as for each CameraFrame.
    CHECK(camera::to_grey({wanted.layout, wanted.width, wanted.height, row, bytes}, &jpeg, &grey).has_value());
    ms.add(to_milliseconds(clock.now() - begun_at));
  }
  const std::string name = fmt::format("{} {}x{}", camera::name_of(wanted.layout), wanted.width, wanted.height);
  fmt::print("{:<24} p50 {:7.3f} ms   p99 {:7.3f} ms\n", name, ms.at(0.5), ms.at(0.99));
  *ret_json += fmt::format("{}\"{}\": {{\"p50_ms\": {:.4f}, \"p99_ms\": {:.4f}}}", ret_json->empty() ? "" : ", ", name,
                           ms.at(0.5), ms.at(0.99));
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  const bool is_quick = argc > 1 && std::string_view(argv[1]) == "--quick";
  std::string json;
  for (const camera::PixelLayout layout : {camera::PixelLayout::kGrey8, camera::PixelLayout::kYuyv,
                                           camera::PixelLayout::kGrey10, camera::PixelLayout::kJpeg}) {
    for (const auto& [width, height] : {std::pair{640, 480}, std::pair{1280, 720}}) {
      measure({layout, width, height}, is_quick ? 50 : 500, &json);
    }
  }
  fmt::print("{{\"benchmark\": \"camera-read\", {}}}\n", json);
  return 0;
}
