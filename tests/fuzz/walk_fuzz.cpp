// SPDX-License-Identifier: Apache-2.0
/// Any polygon and any steps: the eye stays inside.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "kiosk/tour/navigation/walkable_area.h"

namespace {
struct Bytes {
  const std::uint8_t* data;
  std::size_t size;
  Eigen::Vector2d take() {
    double values[2] = {0.0, 0.0};
    // Short numbers make self-touching polygons; whole doubles make all others.
    if (size > 0 && (*data & 1) == 0 && size >= 3) {
      values[0] = static_cast<std::int8_t>(data[1]) / 8.0;
      values[1] = static_cast<std::int8_t>(data[2]) / 8.0;
      skip(3);
    } else if (size >= 1 + sizeof values) {
      std::memcpy(values, data + 1, sizeof values);
      skip(1 + sizeof values);
    } else {
      skip(size);
    }
    return {values[0], values[1]};
  }
  void skip(std::size_t count) {
    data += count;
    size -= count;
  }
};
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes{data, size};
  if (size == 0) return 0;
  const std::size_t count = *data % 24;
  bytes.skip(1);
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i < count; ++i) corners.push_back(bytes.take());
  const auto area = cyclorama::tour::WalkableArea::make(std::move(corners));
  if (!area) return 0;
  Eigen::Vector2d position = area->nearest_allowed(bytes.take());
  CHECK(area->allows(position));
  for (int i = 0; i < 64 && bytes.size > 0; ++i) {
    const Eigen::Vector2d next = area->walk(position, bytes.take());
    CHECK(area->allows(next));
    position = next;
  }
  return 0;
}
