// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/image/image.h"
#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama::simulated {

/// One channel of a camera sees this much of room colour; grey is a camera of one channel.
using CameraChannel = RoomColour;

/// What one picture of one projector is to a camera: a plane of floats per channel, blurred as in focus, with a margin
/// of darkness. Made when first asked for. Thread-bound.
class ProjectorLight {
 public:
  /// An empty picture is a lamp that is off. Borrows nothing.
  explicit ProjectorLight(RgbImage picture = {}) : picture_(std::move(picture)) {}

  struct Plane {
    int width = 0;  ///< With the margins.
    int height = 0;
    std::vector<float>
        light;  ///< In the unit of gain_lux() times the channel's sensitivity and the wall's albedo / pi.
    friend bool operator==(const Plane&, const Plane&) = default;

    /// Bilinear; (u, v) are the projector's pixels, at most kLightMargin_px beyond its edges.
    [[nodiscard]] float at(float u, float v) const;
  };
  [[nodiscard]] bool is_dark() const { return picture_.empty(); }
  /// One plane per channel. Precondition: not is_dark(), and the same museum and projector each time.
  const std::vector<Plane>& planes(const TrueMuseum& museum, std::size_t projector,
                                   const std::vector<CameraChannel>& channels, int threads);
  const InterReflection::Light& direct_light(const TrueMuseum& museum, std::size_t projector);

 private:
  RgbImage picture_;
  std::array<std::vector<Plane>, 2> planes_;  ///< For grey, and for colour.
  InterReflection::Light direct_;
};

}  // namespace cyclorama::simulated
