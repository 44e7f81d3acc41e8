// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/projector_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"
#include "drivers/simulated/museum/camera_table.h"
#include "drivers/simulated/museum/gaussian_blur.h"
#include "drivers/simulated/museum/parallel_rows.h"

namespace cyclorama::simulated {
namespace {

using CodeTable = std::array<std::array<float, 256>, 3>;

/// Contribution of each projector channel's code to the camera channel.
CodeTable table_of(const TrueMuseum& museum, std::size_t projector, const CameraChannel& channel) {
  const ColourMatrix& primaries = museum.truth().projectors[projector].primaries;
  CodeTable table{};
  for (std::size_t c = 0; c < 3; ++c) {
    double seen = 0.0;
    for (std::size_t r = 0; r < 3; ++r)
      seen += channel[r] * museum.truth().albedo[r] / std::numbers::pi * primaries[c][r];
    for (int code = 0; code < 256; ++code) {
      table[c][static_cast<std::size_t>(code)] = static_cast<float>(seen * museum.channel_light(projector, c, code));
    }
  }
  return table;
}

/// A channel of a picture as light, read where lateral colour puts it.
class ChannelLight {
 public:
  ChannelLight(const RgbImage& picture, std::size_t channel, const std::array<float, 256>& table,
               const Eigen::Vector2d& axis_px, double enlargement)
      : picture_(picture), channel_(channel), table_(table), axis_px_(axis_px), scale_(1.0 / (1.0 + enlargement)) {}

  [[nodiscard]] float at(int x, int y) const {
    if (scale_ == 1.0) return code_at(x, y);
    const double u = std::clamp(axis_px_.x() + scale_ * (x + 0.5 - axis_px_.x()) - 0.5, 0.0, picture_.width() - 1.001);
    const double v = std::clamp(axis_px_.y() + scale_ * (y + 0.5 - axis_px_.y()) - 0.5, 0.0, picture_.height() - 1.001);
    const int x0 = static_cast<int>(u);
    const int y0 = static_cast<int>(v);
    const auto fx = static_cast<float>(u - x0);
    const auto fy = static_cast<float>(v - y0);
    const float upper = code_at(x0, y0) + fx * (code_at(x0 + 1, y0) - code_at(x0, y0));
    const float lower = code_at(x0, y0 + 1) + fx * (code_at(x0 + 1, y0 + 1) - code_at(x0, y0 + 1));
    return upper + fy * (lower - upper);
  }

 private:
  [[nodiscard]] float code_at(int x, int y) const { return table_[picture_.at(x, y)[channel_]]; }

  const RgbImage& picture_;
  std::size_t channel_;
  const std::array<float, 256>& table_;
  Eigen::Vector2d axis_px_;
  double scale_;
};

/// Writes a row of what a camera channel sees of a projector with lateral colour and a white segment.
/// `table` has what the camera channel sees of each projector channel.
void add_as_sold(const TrueMuseum& museum, std::size_t projector, const RgbImage& picture, const CodeTable& table,
                 int y, float* row) {
  const TrueProjector& p = museum.truth().projectors[projector];
  const Eigen::Vector2d axis(p.lens.pinhole().centre_u_px, p.lens.pinhole().centre_v_px);
  const ChannelLight channels[] = {{picture, 0, table[0], axis, p.lateral_colour[0]},
                                   {picture, 1, table[1], axis, 0.0},
                                   {picture, 2, table[2], axis, p.lateral_colour[1]}};
  // This is what the camera sees of white, for a unit of light in each channel.
  float white = 0.0f;
  for (std::size_t c = 0; c < 3; ++c) {
    const double all = museum.channel_light(projector, c, 255);
    if (all > 0.0) white += table[c][255] / static_cast<float>(all);
  }
  const std::uint8_t* code = picture.at(0, y);
  for (int x = 0; x < picture.width(); ++x, code += 3) {
    row[x] = channels[0].at(x, y) + channels[1].at(x, y) + channels[2].at(x, y);
    if (p.white_segment > 0.0) {
      row[x] +=
          white * static_cast<float>(museum.white_light(projector, {museum.channel_light(projector, 0, code[0]),
                                                                    museum.channel_light(projector, 1, code[1]),
                                                                    museum.channel_light(projector, 2, code[2])}));
    }
  }
}

/// Returns the blur to apply besides bilinear interpolation, whose tent has twice the variance of a square pixel.
double blur_besides_sampling(double blur_px) {
  const double variance = blur_px * blur_px - 1.0 / 6.0;
  return variance > 0.0 ? std::sqrt(variance) : 0.0;
}

}  // namespace

float ProjectorLight::Plane::at(float u, float v) const {
  constexpr float kToPlane = kLightMargin_px - 0.5f;
  const float x = std::clamp(u + kToPlane, 0.0f, static_cast<float>(width) - 1.001f);
  const float y = std::clamp(v + kToPlane, 0.0f, static_cast<float>(height) - 1.001f);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  const float* row = light.data() + static_cast<std::ptrdiff_t>(y0) * width + x0;
  const float upper = row[0] + fx * (row[1] - row[0]);
  const float lower = row[width] + fx * (row[width + 1] - row[width]);
  return upper + fy * (lower - upper);
}

const std::vector<ProjectorLight::Plane>& ProjectorLight::planes(const TrueMuseum& museum, std::size_t projector,
                                                                 const std::vector<CameraChannel>& channels,
                                                                 int threads) {
  CHECK(!picture_.empty());
  std::vector<Plane>& planes = planes_[channels.size() == 1 ? 0 : 1];
  if (!planes.empty()) return planes;
  const TrueProjector& p = museum.truth().projectors[projector];
  const double blur_px = blur_besides_sampling(p.blur_px);
  const bool is_plain = p.lateral_colour == std::array<double, 2>{} && p.white_segment == 0.0;
  for (const CameraChannel& channel : channels) {
    const CodeTable table = table_of(museum, projector, channel);
    Plane plane;
    plane.width = picture_.width() + 2 * kLightMargin_px;
    plane.height = picture_.height() + 2 * kLightMargin_px;
    plane.light.resize(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height));
    for_rows(picture_.height(), threads, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) {
        const std::uint8_t* code = picture_.at(0, y);
        float* to =
            plane.light.data() + static_cast<std::ptrdiff_t>(y + kLightMargin_px) * plane.width + kLightMargin_px;
        if (!is_plain) {
          add_as_sold(museum, projector, picture_, table, y, to);
          continue;
        }
        for (int x = 0; x < picture_.width(); ++x, code += 3)
          to[x] = table[0][code[0]] + table[1][code[1]] + table[2][code[2]];
      }
    });
    blur_plane(&plane.light, plane.width, plane.height, blur_px, threads);
    planes.push_back(std::move(plane));
  }
  return planes;
}

const InterReflection::Light& ProjectorLight::direct_light(const TrueMuseum& museum, std::size_t projector) {
  if (direct_.empty()) direct_ = museum.direct_light(projector, picture_);
  return direct_;
}

}  // namespace cyclorama::simulated
