// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/head_colour.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace cyclorama::warp {
namespace {

/// Returns the sRGB code for `light` (IEC 61966-2-1).
double srgb_code(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

/// Samples `code` at even steps of the light's square root.
template <typename CodeOfLight>
ResponseCurve sampled(std::size_t steps, const CodeOfLight& code) {
  CHECK(steps >= 2);
  ResponseCurve curve;
  curve.codes.reserve(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    const double root = static_cast<double>(i) / static_cast<double>(steps - 1);
    curve.codes.push_back(static_cast<float>(code(root * root)));
  }
  return curve;
}

double clipped(double light) { return light > 0.0 ? std::min(light, 1.0) : 0.0; }  // NaN also becomes 0.

}  // namespace

bool ResponseCurve::is_valid() const {
  return codes.size() >= 2 && std::ranges::all_of(codes, [](float code) { return code >= 0.0f && code <= 1.0f; });
}

double ResponseCurve::code_of(double light) const {
  CHECK(codes.size() >= 2);
  const double at = std::sqrt(clipped(light)) * static_cast<double>(codes.size() - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(at), codes.size() - 2);
  const double along = at - static_cast<double>(first);
  return (1.0 - along) * static_cast<double>(codes[first]) + along * static_cast<double>(codes[first + 1]);
}

ResponseCurve ResponseCurve::resampled(std::size_t steps) const {
  return sampled(steps, [this](double light) { return code_of(light); });
}

ResponseCurve ResponseCurve::srgb(std::size_t steps) { return sampled(steps, srgb_code); }

ResponseCurve ResponseCurve::power(double gamma, std::size_t steps) {
  return sampled(steps, [gamma](double light) { return std::pow(light, 1.0 / gamma); });
}

Eigen::Vector3d shone_light(const HeadColour& colour, const Eigen::Vector3d& masked_light, double black_lift) {
  Eigen::Vector3d light = masked_light;
  if (colour.matrix) light = *colour.matrix * masked_light;
  if (colour.black_lift) light += black_lift * colour.black;
  return light;
}

Eigen::Vector3d codes_of(const HeadColour& colour, const Eigen::Vector3d& light) {
  Eigen::Vector3d codes;
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    codes[c] = colour.response ? (*colour.response)[channel].code_of(light[c]) : srgb_code(clipped(light[c]));
  }
  return codes;
}

}  // namespace cyclorama::warp
