// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/base/clock.h"
#include "common/geometry/projection.h"
#include "common/image/pixel_rect.h"
#include "common/image/planar_picture.h"

namespace cyclorama::display {

inline constexpr std::int64_t kMaxShowAt_ns = std::int64_t{1} << 62;

/// When something is to be seen first: wire::ShowAt, checked. Without one (period 0) at once.
/// Its refresh is within kMaxShowAt_ns of the clock's zero: 146 years, so that nothing overflows.
struct ShowAt {
  std::int64_t refresh = 0;  ///< The shared refresh's number.
  std::int64_t period_ns = 0;
  std::int64_t told_ns = 0;  ///< On the tour's clock.
};

/// A whole picture, ready to be shown: every tile came, and those that the heads show were decoded. A value; its pixels
/// are shared and never change.
struct DisplayFrame {
  std::uint64_t order = 0;   ///< Counts frames begun by this display; a greater one is newer, whatever `number` says.
  std::uint64_t number = 0;  ///< The view's; 0 is a picture of the display's own.
  double heading_rad = 0.0;
  std::int64_t shutter_ns = 0;  ///< As wire::View; 0 when keys steered.
  PictureShape shape;           ///< Of one eye's picture, with its guard band.
  int stacked = 1;              ///< Such pictures in `picture`: 2 are the left eye's above the right eye's.
  std::shared_ptr<const PlanarPicture> picture;
  std::shared_ptr<const std::vector<PixelRect>> parts;  ///< Of the picture that are valid; null: all of it.
  double turn_limit_rad = 0.0;  ///< How far it may be turned either way, for the heads to see valid parts only.
  std::size_t bytes = 0;        ///< JPEG bytes of all tiles.
  std::uint32_t tiles = 0;      ///< That came,
  std::uint32_t decoded = 0;    ///< and that a head shows.
  TimePoint begun_at{};
  TimePoint decoded_at{};
  ShowAt show_at;
  bool was_shown = false;
};

/// A heading of the visitor's.
struct HeadingNow {
  double heading_rad = 0.0;
  std::int64_t shutter_ns = 0;
  ShowAt show_at{};
  std::uint64_t order = 0;  ///< A greater one is newer.
};

}  // namespace cyclorama::display
