// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/head_drawing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/base/check.h"

namespace cyclorama::scan {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kLine_deg = 2;
constexpr int kStrong_deg = 10;
constexpr double kHalfWidth_deg = 0.06;
constexpr double kSoft_deg = 0.03;  // Width of a line's soft edge: about a projector's pixel.
constexpr double kGround = 0.03;
constexpr double kFaint = 0.45;
constexpr int kCurveSteps = 1024;

/// Returns the brightness of the lines, 0 to 1, at an angle.
double line_at(double angle_rad) {
  const double angle = angle_rad / kDegree;
  const double nearest = std::round(angle / kLine_deg) * kLine_deg;
  const double off = std::abs(angle - nearest);
  const double share = std::clamp((kHalfWidth_deg + kSoft_deg - off) / kSoft_deg, 0.0, 1.0);
  const bool is_strong = std::abs(std::remainder(nearest, static_cast<double>(kStrong_deg))) < 0.5;
  return share * (is_strong ? 1.0 : kFaint);
}

double srgb_code(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

/// Returns tables of each channel's 8-bit codes, at equal steps of the square root of the light, because evaluating the
/// curves per pixel is slow.
std::array<std::vector<std::uint8_t>, 3> code_tables(const warp::HeadColour* colour) {
  std::array<std::vector<std::uint8_t>, 3> tables;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int i = 0; i <= kCurveSteps; ++i) {
      const double root = static_cast<double>(i) / kCurveSteps;
      const double light = root * root;
      const double code =
          colour != nullptr && colour->response ? (*colour->response)[c].code_of(light) : srgb_code(light);
      tables[c].push_back(static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(code, 0.0, 1.0))));
    }
  }
  return tables;
}

}  // namespace

double test_light(TestPicture picture, const Eigen::Vector3d& direction) {
  if (picture == TestPicture::kWhite) return 1.0;
  const double azimuth = std::atan2(direction.x(), -direction.z());
  const double elevation = std::atan2(direction.y(), std::hypot(direction.x(), direction.z()));
  return std::max({kGround, line_at(azimuth), line_at(elevation)});
}

RgbImage drawn_head(const DrawnHead& head, TestPicture picture) {
  CHECK(head.mask == nullptr || (head.mask->width() == head.width_px && head.mask->height() == head.height_px));
  const auto tables = code_tables(head.colour);
  const warp::BlackLiftImage* black_lift =
      head.colour != nullptr && head.colour->black_lift ? &*head.colour->black_lift : nullptr;
  CHECK(black_lift == nullptr || (black_lift->width() == head.width_px && black_lift->height() == head.height_px));
  RgbImage image(head.width_px, head.height_px);
  for (int y = 0; y < head.height_px; ++y) {
    for (int x = 0; x < head.width_px; ++x) {
      const auto direction = head.direction_at({x + 0.5, y + 0.5});
      if (!direction) continue;
      const double mask = head.mask == nullptr ? 1.0 : static_cast<double>(*head.mask->at(x, y));
      Eigen::Vector3d light = Eigen::Vector3d::Constant(mask * test_light(picture, *direction));
      if (head.colour != nullptr)
        light = warp::shone_light(*head.colour, light,
                                  black_lift == nullptr ? 0.0 : static_cast<double>(*black_lift->at(x, y)));
      std::uint8_t* const pixel = image.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        const double root = std::sqrt(std::clamp(light(static_cast<Eigen::Index>(c)), 0.0, 1.0));
        pixel[c] = tables.at(c)[static_cast<std::size_t>(std::lround(kCurveSteps * root))];
      }
    }
  }
  return image;
}

}  // namespace cyclorama::scan
