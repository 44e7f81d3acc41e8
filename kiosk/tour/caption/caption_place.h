// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/projection.h"
#include "common/wire/museum.pb.h"
#include "kiosk/tour/caption/caption_setter.h"
#include "kiosk/tour/plan/tour_plan.h"

namespace cyclorama::tour {

/// The wall on which captions are written, as its displays report it.
struct CaptionWall {
  PictureShape shape = Panorama{};
  double min_px_per_rad = 0.0;  ///< The coarsest projector's; above 0.
  double max_px_per_rad = 0.0;  ///< The finest one's.
  friend bool operator==(const CaptionWall&, const CaptionWall&) = default;
};

/// Smallest capital letter that stays readable with any projector.
inline constexpr double kMinLetterPx = 9.0;

/// Returns the size in which captions are set: as large as the style demands from the sweet spot, or larger where a
/// projector's pixels are coarse; as fine as the finest projector. `languages` are written at once.
[[nodiscard]] CaptionSize caption_size(const CaptionStyle& style, const CaptionWall& wall, std::size_t languages);

/// Returns the message for a page that was set in that size: its direction and size. Where the style names no
/// elevation, it is at the wall's upper edge: projectors hang above the visitors' heads, so that shadows fall below.
[[nodiscard]] wire::Caption caption_on_wall(const CaptionPage& page, const CaptionStyle& style,
                                            const CaptionWall& wall);

}  // namespace cyclorama::tour
