// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/comparable.h"

#include <fmt/format.h>

#include <cmath>

namespace cyclorama::quality {

Status check_same_size(int width, int height, int reference_width, int reference_height) {
  if (width == reference_width && height == reference_height && width > 0 && height > 0) return Done{};
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("a picture of {}x{} pixels cannot be compared with one of {}x{}", width, height,
                           reference_width, reference_height));
}

Status check_finite(const RadianceImage& picture) {
  for (std::size_t i = 0; i < picture.data().size(); ++i) {
    if (std::isfinite(picture.data()[i])) continue;
    const std::size_t x = i % picture.row_values() / 3;
    const std::size_t y = i / picture.row_values();
    return Error(ErrorCode::kBadData, fmt::format("pixel ({}, {}) is {}", x, y, picture.data()[i]));
  }
  return Done{};
}

Status check_comparable(const RadianceImage& picture, const RadianceImage& reference) {
  TRY(check_same_size(picture.width(), picture.height(), reference.width(), reference.height()));
  if (Status status = check_finite(picture); !status) return std::move(status).error().while_doing("the picture");
  if (Status status = check_finite(reference); !status) return std::move(status).error().while_doing("the reference");
  return Done{};
}

}  // namespace cyclorama::quality
