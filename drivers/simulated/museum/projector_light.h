// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/image/image.h"
#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama::simulated {

/// Sensitivity of one camera channel to room colour; a grey camera has one channel.
using CameraChannel = RoomColour;

/// The light of one projector picture for a camera: one plane of floats per channel, blurred as in focus, with a dark
/// margin. Computed on first use. Thread-bound.
class ProjectorLight {
 public:
  /// An empty picture means that the lamp is off. Borrows nothing.
  explicit ProjectorLight(RgbImage picture = {}) : picture_(std::move(picture)) {}

  struct Plane {
    int width = 0;  ///< Including the margins.
    int height = 0;
    std::vector<float>
        light;  ///< In the unit of gain_lux() times the channel's sensitivity and the wall's albedo / pi.
    friend bool operator==(const Plane&, const Plane&) = default;

    /// Interpolates bilinearly; (u, v) are projector pixels, at most kLightMargin_px beyond the edges.
    [[nodiscard]] float at(float u, float v) const;
  };
  [[nodiscard]] bool is_dark() const { return picture_.empty(); }
  /// Returns one plane per channel. Preconditions: not is_dark(); the same museum and projector in each call.
  const std::vector<Plane>& planes(const TrueMuseum& museum, std::size_t projector,
                                   const std::vector<CameraChannel>& channels, int threads);
  const InterReflection::Light& direct_light(const TrueMuseum& museum, std::size_t projector);

 private:
  RgbImage picture_;
  std::array<std::vector<Plane>, 2> planes_;  ///< Planes for grey and for colour.
  InterReflection::Light direct_;
};

}  // namespace cyclorama::simulated
