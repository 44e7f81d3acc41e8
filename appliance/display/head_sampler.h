// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "appliance/display/frame.h"
#include "appliance/display/head_upload.h"

namespace cyclorama::display {

/// Computes on the processor, at reduced size, the picture that the graphics card draws for one head, to compare the
/// wall's picture with a camera's. A value; reentrant.
///
/// Each output pixel stands for `factor` by `factor` head pixels. It has the picture's value at the middle of these
/// pixels (a panorama has about as many pixels as the heads, so hardly any detail is missed), times the mean of their
/// mask values. There is no dither.
class HeadSampler {
 public:
  /// The result is smaller by `factor` each way, rounded down. Preconditions: the plan is for one eye's picture, and
  /// factor > 0.
  HeadSampler(const HeadPlan& plan, int factor);

  /// Returns the head's code values while it shows `frame` turned to the right by `turn_rad`; black outside of the
  /// picture. Precondition: the frame has the kind and tilt of the plan's picture.
  [[nodiscard]] RgbImage draw(const DisplayFrame& frame, double turn_rad) const;

  [[nodiscard]] int width_px() const { return width_; }
  [[nodiscard]] int height_px() const { return height_; }

 private:
  struct Place {
    float across = 0.0f;
    float up = 0.0f;
    float weight = 0.0f;  ///< 0: the pixel is black.
    float black_lift = 0.0f;
  };
  [[nodiscard]] std::uint8_t code_of(double light, std::size_t channel) const;

  int width_;
  int height_;
  PictureShape picture_;
  warp::HeadColour colour_;
  std::vector<Place> samples_;
  /// Code values of each channel, indexed by the light's square root.
  std::array<std::vector<std::uint8_t>, 3> codes_;
};

}  // namespace cyclorama::display
