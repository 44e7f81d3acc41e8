// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/flip.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/image/colour.h"
#include "renderfarm/quality/comparable.h"
#include "renderfarm/quality/separable_filter.h"

namespace cyclorama::quality {
namespace {

using Eigen::Vector3f;
using Plane = Image<float, 1>;
/// Three values per pixel, each in a separate plane.
using Planes = std::array<Plane, 3>;

// Constants with their names in the paper.
constexpr float kColourExponent = 0.7f;     // q_c
constexpr float kColourKnee = 0.4f;         // p_c
constexpr float kErrorAtKnee = 0.95f;       // p_t
constexpr float kFeatureExponent = 0.5f;    // q_f
constexpr double kFeatureWidthDeg = 0.082;  // w

/// One of the Gaussians whose sum is the spatial contrast sensitivity: a · √(π / b) · exp(-π² x² / b), x in degrees.
struct Lobe {
  double a;
  double b;
};
constexpr std::array<std::array<Lobe, 2>, 3> kSensitivity = {{
    {{{1.0, 0.0047}, {0.0, 0.0047}}},  // Achromatic.
    {{{1.0, 0.0053}, {0.0, 0.0053}}},  // Red to green.
    {{{34.1, 0.04}, {13.5, 0.025}}},   // Blue to yellow.
}};
constexpr double kMaxLobeWidthDeg = 0.04;

/// Conversion between linear sRGB and XYZ, with the coefficients of the authors' programs. XYZ is divided by the white
/// point (D65), so each row adds up to 1.
struct ColourSpace {
  Eigen::Matrix3f xyz_of_rgb;
  Eigen::Matrix3f rgb_of_xyz;
  ColourSpace() {
    Eigen::Matrix3d m;
    m << 10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0,  //
        2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0,     //
        1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0;
    m.array().colwise() /= m.rowwise().sum().array().eval();
    xyz_of_rgb = m.cast<float>();
    rgb_of_xyz = m.inverse().cast<float>();
  }
};

/// Returns YCxCz, which is CIELAB without the cube roots, so that it is linear and may be filtered.
Vector3f opponent_of_xyz(const Vector3f& xyz) {
  return {116.0f * xyz.y() - 16.0f, 500.0f * (xyz.x() - xyz.y()), 200.0f * (xyz.y() - xyz.z())};
}

Vector3f xyz_of_opponent(const Vector3f& opponent) {
  const float y = (opponent.x() + 16.0f) / 116.0f;
  return {y + opponent.y() / 500.0f, y, y - opponent.z() / 200.0f};
}

/// Returns CIELAB with a and b scaled by lightness, because dim colours look less colourful (Hunt effect).
Vector3f hunt_lab_of_xyz(const Vector3f& xyz) {
  constexpr float kDelta = 6.0f / 29.0f;
  const auto root = [](float t) {
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
  };
  const float x = root(xyz.x());
  const float y = root(xyz.y());
  const float z = root(xyz.z());
  const float lightness = 116.0f * y - 16.0f;
  return {lightness, 0.01f * lightness * 500.0f * (x - y), 0.01f * lightness * 200.0f * (y - z)};
}

/// Returns the HyAB distance between two colours from hunt_lab_of_xyz().
float distance(const Vector3f& a, const Vector3f& b) {
  const Vector3f d = a - b;
  return std::abs(d.x()) + std::hypot(d.y(), d.z());
}

Vector3f pixel_of(const Planes& planes, std::size_t i) {
  return {planes[0].data()[i], planes[1].data()[i], planes[2].data()[i]};
}

Planes opponent_of(const RgbImage& picture, const ColourSpace& space) {
  std::array<float, 256> linear{};
  for (std::size_t code = 0; code < 256; ++code) linear[code] = srgb_to_linear(static_cast<float>(code) / 255.0f);
  Planes planes;
  for (Plane& plane : planes) plane = Plane(picture.width(), picture.height());
  for (std::size_t i = 0; i < planes[0].data().size(); ++i) {
    const std::uint8_t* const rgb = &picture.data()[3 * i];
    const Vector3f opponent =
        opponent_of_xyz(space.xyz_of_rgb * Vector3f(linear[rgb[0]], linear[rgb[1]], linear[rgb[2]]));
    for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].data()[i] = opponent[c];
  }
  return planes;
}

/// Filters a plane by the resolution of the eye (section 4.1.1).
Plane seen(const Plane& plane, const std::array<Lobe, 2>& lobes, double pixels_per_degree) {
  const auto sigma_px = [&](double b) { return std::sqrt(b / 2.0) / std::numbers::pi * pixels_per_degree; };
  const int radius = static_cast<int>(std::ceil(3.0 * sigma_px(kMaxLobeWidthDeg)));
  std::array<Kernel, 2> kernels;
  std::array<double, 2> weights{};
  for (std::size_t i = 0; i < lobes.size(); ++i) {
    const Kernel kernel = gaussian(radius, sigma_px(lobes[i].b));
    weights[i] = lobes[i].a * std::sqrt(std::numbers::pi / lobes[i].b) * sum_of(kernel) * sum_of(kernel);
    kernels[i] = normalized(kernel);
  }
  Plane result(plane.width(), plane.height());
  for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
    if (weights[lobe] == 0.0) continue;
    const Plane part = filtered(plane, kernels[lobe], kernels[lobe]);
    const auto weight = static_cast<float>(weights[lobe] / (weights[0] + weights[1]));
    for (std::size_t i = 0; i < part.data().size(); ++i) result.data()[i] += weight * part.data()[i];
  }
  return result;
}

/// Returns colours as perceived: filtered, clamped to the display's gamut, in Hunt-adjusted CIELAB.
Planes perceived(const Planes& opponent, const ColourSpace& space, double pixels_per_degree) {
  Planes planes;
  for (std::size_t c = 0; c < 3; ++c) planes[c] = seen(opponent[c], kSensitivity[c], pixels_per_degree);
  for (std::size_t i = 0; i < planes[0].data().size(); ++i) {
    const Vector3f rgb = (space.rgb_of_xyz * xyz_of_opponent(pixel_of(planes, i))).cwiseMax(0.0f).cwiseMin(1.0f);
    const Vector3f lab = hunt_lab_of_xyz(space.xyz_of_rgb * rgb);
    for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].data()[i] = lab[c];
  }
  return planes;
}

/// Scales the positive weights to a sum of 1 and the negative weights to a sum of -1.
Kernel balanced(Kernel kernel) {
  double positive = 0.0;
  double negative = 0.0;
  for (const double weight : kernel) (weight > 0.0 ? positive : negative) += weight;
  for (double& weight : kernel) weight /= weight > 0.0 ? positive : -negative;
  return kernel;
}

/// Strength of edges and of points at each pixel (section 4.2):
struct Features {
  Plane edge;
  Plane point;
};

Features features_of(const Plane& achromatic, double pixels_per_degree) {
  const double sigma_px = 0.5 * kFeatureWidthDeg * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma_px));
  const Kernel across = gaussian(radius, sigma_px);
  Kernel edge = across;
  Kernel point = across;
  for (int x = -radius; x <= radius; ++x) {
    const auto k = static_cast<std::size_t>(x + radius);
    edge[k] *= -x;
    point[k] *= x * x / (sigma_px * sigma_px) - 1.0;
  }
  const Plane smooth_rows = filtered_along_rows(achromatic, normalized(across));
  const auto strength = [&](const Kernel& kernel) {
    Plane x = filtered_along_columns(filtered_along_rows(achromatic, kernel), normalized(across));
    const Plane y = filtered_along_columns(smooth_rows, kernel);
    for (std::size_t i = 0; i < x.data().size(); ++i) x.data()[i] = std::hypot(x.data()[i], y.data()[i]);
    return x;
  };
  return {strength(balanced(edge)), strength(balanced(point))};
}

Plane achromatic_of(const Planes& opponent) {
  Plane plane = opponent[0];
  for (float& value : plane.data()) value = (value + 16.0f) / 116.0f;  // The divisor 116 is from the errata.
  return plane;
}

/// Maps an error to [0, 1]; most of that range is for errors below the knee (section 4.1.3). `max` is the maximum error
/// of any two colours.
float redistributed(float power, float max) {
  const float knee = kColourKnee * max;
  if (power < knee) return kErrorAtKnee / knee * power;
  return kErrorAtKnee + (power - knee) / (max - knee) * (1.0f - kErrorAtKnee);
}

}  // namespace

Result<Flip> flip(const RgbImage& picture, const RgbImage& reference, double pixels_per_degree) {
  TRY(check_same_size(picture.width(), picture.height(), reference.width(), reference.height()));
  if (!(pixels_per_degree >= 1.0 && pixels_per_degree <= 1000.0)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("{} pixels per degree were requested; it must be 1 to 1000", pixels_per_degree));
  }
  const ColourSpace space;
  const Planes opponent_a = opponent_of(picture, space);
  const Planes opponent_b = opponent_of(reference, space);
  const Planes perceived_a = perceived(opponent_a, space, pixels_per_degree);
  const Planes perceived_b = perceived(opponent_b, space, pixels_per_degree);
  const Features features_a = features_of(achromatic_of(opponent_a), pixels_per_degree);
  const Features features_b = features_of(achromatic_of(opponent_b), pixels_per_degree);
  const float max = std::pow(
      distance(hunt_lab_of_xyz(space.xyz_of_rgb.col(1)), hunt_lab_of_xyz(space.xyz_of_rgb.col(2))), kColourExponent);
  Flip result{0.0, Plane(picture.width(), picture.height())};
  for (std::size_t i = 0; i < result.each.data().size(); ++i) {
    const float colour =
        redistributed(std::pow(distance(pixel_of(perceived_a, i), pixel_of(perceived_b, i)), kColourExponent), max);
    const float feature = std::max(std::abs(features_a.edge.data()[i] - features_b.edge.data()[i]),
                                   std::abs(features_a.point.data()[i] - features_b.point.data()[i]));
    const float strength = std::min(1.0f, std::pow(feature / std::numbers::sqrt2_v<float>, kFeatureExponent));
    const float error = std::pow(colour, 1.0f - strength);
    result.each.data()[i] = error;
    result.mean += static_cast<double>(error);
  }
  result.mean /= static_cast<double>(result.each.data().size());
  return result;
}

}  // namespace cyclorama::quality
