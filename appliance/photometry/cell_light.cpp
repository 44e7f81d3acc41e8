// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/cell_light.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "appliance/photometry/ramp_blocks.h"

namespace cyclorama::photometry {
namespace {

constexpr int kMinPixels = 6;

struct Mean {
  double sum = 0.0;
  double weight = 0.0;
  void add(double value, double factor, double sigma) {
    const double w = factor / (sigma * sigma);
    sum += w * value;
    weight += factor * w;
  }
  [[nodiscard]] std::optional<double> value() const {
    return weight > 0.0 ? std::optional(sum / weight) : std::nullopt;
  }
  [[nodiscard]] double sigma() const { return 1.0 / std::sqrt(weight); }
};

/// Light per unit of exposure, and its sigma.
struct Linear {
  double light = 0.0;
  double sigma = 0.0;
};
std::optional<Linear> linear_of(const CellCode& code, std::size_t channel, int pixels, double exposure_s,
                                const CameraResponse& camera, double code_step) {
  if (code.is_clipped.at(channel)) return std::nullopt;
  const double value = static_cast<double>(code.code.at(channel));
  const double slope = std::clamp(camera.slope_at(value), 0.2, 5.0);
  const double sigma = slope * code_sigma(code, channel, pixels, code_step) / exposure_s;
  return Linear{camera.light_of(value) / exposure_s, sigma};
}

std::size_t primary_of(structured_light::PatternLight light) {
  return light == structured_light::PatternLight::kRed ? 0 : light == structured_light::PatternLight::kGreen ? 1 : 2;
}

/// Light of one cell in one channel of the camera.
struct ChannelLight {
  Mean black;
  std::array<Mean, 3> primaries;
  Mean white;
};

ChannelLight channel_light(const ProjectorView& view, std::size_t cell, std::size_t channel,
                           const CameraResponse& camera, const std::array<ChannelResponse, 3>& curves,
                           double code_step) {
  ChannelLight result;
  const int pixels = view.cells.cells[cell].pixels;
  for (const LightReading& reading : view.readings) {
    if (reading.level > 0.0) continue;
    const auto seen = linear_of(reading.codes[cell], channel, pixels, reading.exposure_s, camera, code_step);
    if (seen) result.black.add(seen->light, 1.0, seen->sigma);
  }
  const auto black = result.black.value();
  if (!black) return result;
  for (const LightReading& reading : view.readings) {
    if (!(reading.level > 0.0)) continue;
    const auto seen = linear_of(reading.codes[cell], channel, pixels, reading.exposure_s, camera, code_step);
    if (!seen) continue;
    const double sigma = std::hypot(seen->sigma, result.black.sigma());
    if (reading.light == structured_light::PatternLight::kAll) {
      if (reading.level == 1.0) result.white.add(seen->light - *black, 1.0, sigma);
      continue;
    }
    const std::size_t light = primary_of(reading.light);
    const double part = curves.at(light).light_of(reading.level);
    // At dark levels the curve is too uncertain to give the primary's light.
    if (part > 0.2) result.primaries.at(light).add(seen->light - *black, part, sigma);
  }
  return result;
}

}  // namespace

std::vector<CellLight> cell_lights(const PhotometryInput& input, const ProjectorView& view,
                                   const CameraResponse& camera, const std::array<ChannelResponse, 3>& curves) {
  std::vector<CellLight> lights;
  const std::size_t channels = input.has_colour ? 3 : 1;
  for (std::size_t cell = 0; cell < view.cells.cells.size(); ++cell) {
    if (view.cells.cells[cell].pixels < kMinPixels) continue;
    CellLight light;
    light.cell = cell;
    light.has_primaries = light.has_white = true;
    bool has_black = true;
    double variance = 0.0;
    double total = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const ChannelLight seen = channel_light(view, cell, std::min(k, channels - 1), camera, curves, input.code_step);
      const auto row = static_cast<Eigen::Index>(k);
      has_black &= seen.black.value().has_value();
      if (!has_black) break;
      light.black(row) = *seen.black.value();
      light.black_sigma(row) = seen.black.sigma();
      for (std::size_t p = 0; p < 3; ++p) {
        const auto value = seen.primaries.at(p).value();
        light.has_primaries &= value.has_value();
        light.primaries(row, static_cast<Eigen::Index>(p)) = value.value_or(0.0);
      }
      const auto white = seen.white.value();
      light.has_white &= white.has_value();
      light.white(row) = white.value_or(0.0);
      const double sum = white ? *white : light.primaries.row(row).sum();
      const double sigma = white                            ? seen.white.sigma()
                           : seen.primaries[1].weight > 0.0 ? seen.primaries[1].sigma()
                                                            : 0.0;
      total += sum;
      variance += sigma * sigma;
    }
    if (!has_black || (!light.has_white && !light.has_primaries) || !(total > 0.0)) continue;
    light.sigma = std::sqrt(variance) / total;
    lights.push_back(light);
  }
  return lights;
}

}  // namespace cyclorama::photometry
