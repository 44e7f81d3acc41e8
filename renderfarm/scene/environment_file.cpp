// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/environment_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "common/base/text.h"
#include "common/image/radiance_file.h"

namespace cyclorama::scene {
namespace {

/// Returns the solid angle of a texel of row `y`, up to a factor that all rows share.
double solid_angle(int y, int height) {
  const double step = std::numbers::pi / height;
  return std::cos(y * step) - std::cos((y + 1) * step);
}

}  // namespace

RadianceImage halved_environment(const RadianceImage& pixels) {
  RadianceImage half((pixels.width() + 1) / 2, (pixels.height() + 1) / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      double all = 0.0;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int row = 2 * y; row < std::min(2 * y + 2, pixels.height()); ++row) {
        const double weight = solid_angle(row, pixels.height());
        for (int column = 2 * x; column < std::min(2 * x + 2, pixels.width()); ++column) {
          sum += weight * Eigen::Map<const Eigen::Vector3f>(pixels.at(column, row)).cast<double>();
          all += weight;
        }
      }
      Eigen::Map<Eigen::Vector3f>(half.at(x, y)) = (sum / all).cast<float>();
    }
  }
  return half;
}

Eigen::Vector3f mean_radiance(const EnvironmentMap& environment) {
  const RadianceImage& pixels = environment.pixels;
  double all = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int y = 0; y < pixels.height(); ++y) {
    const double weight = solid_angle(y, pixels.height());
    for (int x = 0; x < pixels.width(); ++x) {
      sum += weight * Eigen::Map<const Eigen::Vector3f>(pixels.at(x, y)).cast<double>();
    }
    all += weight * pixels.width();
  }
  return (environment.strength * sum / all).cast<float>();
}

Result<RadianceImage> read_environment(const std::filesystem::path& file, const ImportLimits& limits,
                                       std::vector<std::string>* ret_notes) {
  // A map and its half are in memory at the same time.
  constexpr std::size_t kBytesPerPixel = 2 * 3 * sizeof(float);
  TRY_ASSIGN(RadianceImage pixels,
             read_radiance(file, std::min(limits.texture_px, limits.memory_bytes / kBytesPerPixel)));
  const int width = pixels.width();
  const int height = pixels.height();
  if (std::abs(width - 2 * height) > 1) {
    return Error(ErrorCode::kBadData,
                 fmt::format("the environment '{}' is {}x{} pixels; give an equirectangular picture, which is twice as "
                             "wide as high",
                             file.string(), width, height));
  }
  while (pixels.width() > kMaxEnvironmentWidthPx) pixels = halved_environment(pixels);
  if (pixels.width() != width) {
    ret_notes->push_back(fmt::format("the environment '{}' of {}x{} pixels is taken as {}x{}",
                                     printable(file.filename().string()), width, height, pixels.width(),
                                     pixels.height()));
  }
  return pixels;
}

}  // namespace cyclorama::scene
