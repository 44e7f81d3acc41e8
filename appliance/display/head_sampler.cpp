// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_sampler.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::display {
namespace {

constexpr std::size_t kSteps = 2048;  // Steps of the light's square root; a code value covers at least two of them.

/// Returns the linear light of each sRGB code value (IEC 61966-2-1).
const std::array<float, 256>& light_of_code() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> made{};
    for (std::size_t i = 0; i < made.size(); ++i) {
      const double code = static_cast<double>(i) / 255.0;
      made[i] = static_cast<float>(code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4));
    }
    return made;
  }();
  return table;
}

/// Interpolates codes bilinearly between centres, like a texture; clamps at edges, and wraps around a whole turn.
class Plane {
 public:
  Plane(const GreyImage& plane, int width, int height, bool goes_round)
      : plane_(plane), width_(width), height_(height), goes_round_(goes_round) {}

  [[nodiscard]] float at(double u, double v) const {
    const double x = u - 0.5;
    const double y = std::clamp(v - 0.5, 0.0, height_ - 1.0);
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(y);
    const auto across = static_cast<float>(x - x0);
    const auto down = static_cast<float>(y - y0);
    const int left = column(x0);
    const int right = column(x0 + 1);
    const int below = std::min(y0 + 1, height_ - 1);
    const float a = *plane_.at(left, y0);
    const float b = *plane_.at(right, y0);
    const float c = *plane_.at(left, below);
    const float d = *plane_.at(right, below);
    return (1.0f - down) * (a + across * (b - a)) + down * (c + across * (d - c));
  }

 private:
  [[nodiscard]] int column(int x) const {
    return goes_round_ ? ((x % width_) + width_) % width_ : std::clamp(x, 0, width_ - 1);
  }
  const GreyImage& plane_;
  int width_;
  int height_;
  bool goes_round_;
};

std::uint8_t rounded(float code) { return static_cast<std::uint8_t>(std::clamp(code + 0.5f, 0.0f, 255.0f)); }

}  // namespace

HeadSampler::HeadSampler(const HeadPlan& plan, int factor)
    : width_(warp::width_px(plan.warp) / factor),
      height_(warp::height_px(plan.warp) / factor),
      picture_(plan.picture),
      colour_(plan.colour) {
  CHECK(factor > 0 && !plan.packing);
  samples_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  // The middle of an even block lies between four pixels.
  const int first = (factor - 1) / 2;
  const int last = factor / 2;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      Place& position =
          samples_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
      double weight = 0.0;
      double black_lift = 0.0;
      for (int k = 0; k < factor * factor; ++k) {
        const int px = x * factor + k % factor;
        const int py = y * factor + k / factor;
        weight += static_cast<double>(*plan.mask.at(px, py));
        if (plan.colour.black_lift) black_lift += static_cast<double>(*plan.colour.black_lift->at(px, py));
      }
      double across = 0.0;
      double up = 0.0;
      int met = 0;
      for (const int dy : {first, last}) {
        for (const int dx : {first, last}) {
          const auto direction = direction_at(plan.warp, x * factor + dx, y * factor + dy);
          if (!direction) continue;
          across += direction->azimuth_rad;
          up += direction->tan_elevation;
          ++met;
        }
      }
      if (met < 4) continue;
      position = {static_cast<float>(across / met), static_cast<float>(up / met),
                  static_cast<float>(weight / (factor * factor)), static_cast<float>(black_lift / (factor * factor))};
    }
  }
  for (std::size_t channel = 0; channel < codes_.size(); ++channel) {
    const warp::ResponseCurve curve =
        colour_.response ? (*colour_.response)[channel].resampled(kSteps) : warp::ResponseCurve::srgb(kSteps);
    for (const float code : curve.codes) codes_[channel].push_back(rounded(255.0f * code));
  }
}

std::uint8_t HeadSampler::code_of(double light, std::size_t channel) const {
  const double root = light > 0.0 ? std::sqrt(std::min(light, 1.0)) : 0.0;
  return codes_[channel][static_cast<std::size_t>(root * (kSteps - 1.0) + 0.5)];
}

RgbImage HeadSampler::draw(const DisplayFrame& frame, double turn_rad) const {
  CHECK(has_same_places(frame.shape, picture_) && frame.picture != nullptr);
  RgbImage head(width_, height_);
  const PlanarPicture& picture = *frame.picture;
  const auto* const panorama = std::get_if<Panorama>(&frame.shape);
  const bool goes_round = panorama != nullptr && is_whole_turn(*panorama);
  const PixelScale scale = pixel_scale(frame.shape);
  const int width = cyclorama::width_px(frame.shape);
  const int height = cyclorama::height_px(frame.shape);
  const double chroma = picture.has_half_chroma() ? 0.5 : 1.0;
  const Plane luma(picture.luma(), width, height, goes_round);
  const int chroma_width = static_cast<int>(std::lround(std::ceil(chroma * width)));
  const int chroma_height = static_cast<int>(std::lround(std::ceil(chroma * height)));
  const Plane blue(picture.blue(), chroma_width, chroma_height, goes_round);
  const Plane red(picture.red(), chroma_width, chroma_height, goes_round);
  const bool is_plain = !colour_.matrix && !colour_.black_lift;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Place& position = samples_[i];
    if (position.weight <= 0.0f && position.black_lift <= 0.0f) continue;
    PicturePlace at{static_cast<double>(position.across), static_cast<double>(position.up)};
    if (panorama != nullptr) {
      at.across += turn_rad;
    } else {
      const auto moved = turned(frame.shape, at, turn_rad);
      if (!moved) continue;
      at = *moved;
    }
    const PanoramaPixel pixel = scale.pixel_at(at);
    if (!(pixel.v >= 0.0 && pixel.v <= height)) continue;
    if (!goes_round && !(pixel.u >= 0.0 && pixel.u <= width)) continue;
    const float y = luma.at(pixel.u, pixel.v);
    const float cb = blue.at(chroma * pixel.u, chroma * pixel.v) - 128.0f;
    const float cr = red.at(chroma * pixel.u, chroma * pixel.v) - 128.0f;
    const std::array<std::uint8_t, 3> rgb{rounded(y + 1.402f * cr), rounded(y - 0.344136f * cb - 0.714136f * cr),
                                          rounded(y + 1.772f * cb)};
    Eigen::Vector3d light;
    for (std::size_t c = 0; c < 3; ++c)
      light[static_cast<Eigen::Index>(c)] = static_cast<double>(position.weight * light_of_code()[rgb[c]]);
    if (!is_plain) light = warp::shone_light(colour_, light, static_cast<double>(position.black_lift));
    std::uint8_t* const to = head.data().data() + 3 * i;
    for (std::size_t c = 0; c < 3; ++c) to[c] = code_of(light[static_cast<Eigen::Index>(c)], c);
  }
  return head;
}

}  // namespace cyclorama::display
