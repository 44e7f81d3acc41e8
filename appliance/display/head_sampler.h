// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "appliance/display/frame.h"
#include "appliance/display/head_upload.h"

namespace cyclorama::display {

/// What the graphics card makes of a picture for one head, made again by the processor and smaller: for who compares
/// what the wall shows with what a camera sees. A value; reentrant.
///
/// Of `factor` pixels each way the middle is sampled (a panorama has about as many pixels as the heads, so that hardly
/// anything falls between), the mask is their mean. Without dither.
class HeadSampler {
 public:
  /// Preconditions: the plan is of one eye's picture, and factor > 0. Smaller by `factor` each way, rounded down.
  HeadSampler(const HeadPlan& plan, int factor);

  /// Code values of the head while it shows `frame`, turned to the right by `turn_rad`. Black where the picture has
  /// nothing. Precondition: the frame's places are those of the plan's picture.
  [[nodiscard]] RgbImage draw(const DisplayFrame& frame, double turn_rad) const;

  [[nodiscard]] int width_px() const { return width_; }
  [[nodiscard]] int height_px() const { return height_; }

 private:
  struct Place {
    float across = 0.0f;
    float up = 0.0f;
    float weight = 0.0f;  ///< 0: black.
    float black_lift = 0.0f;
  };
  [[nodiscard]] std::uint8_t code_of(double light, std::size_t channel) const;

  int width_;
  int height_;
  PictureShape picture_;
  warp::HeadColour colour_;
  std::vector<Place> samples_;
  /// By the light's square root.
  std::array<std::vector<std::uint8_t>, 3> codes_;
};

}  // namespace cyclorama::display
