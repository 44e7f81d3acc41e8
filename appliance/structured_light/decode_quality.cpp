// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/decode_quality.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace cyclorama::structured_light {
namespace {

constexpr int kTilePx = 16;
constexpr std::size_t kMinPixelsInTile = 64;
constexpr double kSmooth = 0.8;

struct Sample {
  double u = 0.0;
  double v = 0.0;
  double x = 0.0;
  double y = 0.0;
};

/// Plane x = c[0] + c[1] u + c[2] v.
struct Plane {
  std::array<double, 3> c = {};
  [[nodiscard]] double at(const Sample& s) const { return c[0] + c[1] * s.u + c[2] * s.v; }
};

/// Returns the least-squares plane of the marked samples. The normal equations are well conditioned, since u and v are
/// small and centred.
Plane plane_through(const std::vector<Sample>& samples, const std::vector<char>& is_used, double Sample::*value) {
  double n = 0, su = 0, sv = 0, suu = 0, suv = 0, svv = 0, sx = 0, sux = 0, svx = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (is_used[i] == 0) continue;
    const Sample& s = samples[i];
    n += 1.0;
    su += s.u;
    sv += s.v;
    suu += s.u * s.u;
    suv += s.u * s.v;
    svv += s.v * s.v;
    sx += s.*value;
    sux += s.u * s.*value;
    svx += s.v * s.*value;
  }
  if (n < 3.0) return {};
  const double uu = suu - su * su / n;
  const double uv = suv - su * sv / n;
  const double vv = svv - sv * sv / n;
  const double ux = sux - su * sx / n;
  const double vx = svx - sv * sx / n;
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 1e-9)) return {{sx / n, 0.0, 0.0}};
  const double a = (vv * ux - uv * vx) / determinant;
  const double b = (uu * vx - uv * ux) / determinant;
  return {{(sx - a * su - b * sv) / n, a, b}};
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Returns the distances of the samples from robustly fitted planes. The first fit uses the samples near the medians,
/// later fits those near the previous planes.
std::vector<double> distances_in(const std::vector<Sample>& samples) {
  std::vector<double> xs, ys;
  for (const Sample& s : samples) {
    xs.push_back(s.x);
    ys.push_back(s.y);
  }
  const double x = median_of(xs);
  const double y = median_of(ys);
  std::vector<char> is_used(samples.size(), 0);
  std::vector<double> distances(samples.size(), 0.0);
  // The slope within a tile spreads its positions, so only samples far beyond this spread are left out at first.
  for (std::size_t i = 0; i < samples.size(); ++i) distances[i] = std::hypot(samples[i].x - x, samples[i].y - y);
  double max = std::max(kGrossPx, 3.0 * median_of(distances));
  for (int round = 0; round < 4; ++round) {
    for (std::size_t i = 0; i < samples.size(); ++i) is_used[i] = distances[i] <= max ? 1 : 0;
    const Plane px = plane_through(samples, is_used, &Sample::x);
    const Plane py = plane_through(samples, is_used, &Sample::y);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      distances[i] = std::hypot(samples[i].x - px.at(samples[i]), samples[i].y - py.at(samples[i]));
    }
    max = kGrossPx;
  }
  return distances;
}

}  // namespace

DecodeQuality quality_of(const Decoded& decoded, double lit_amplitude) {
  DecodeQuality quality;
  int decoded_and_lit = 0;
  for (std::size_t i = 0; i < decoded.fate.data().size(); ++i) {
    const PixelFate fate = decoded.fate.data()[i];
    ++quality.fates.at(static_cast<std::size_t>(fate));
    if (static_cast<double>(decoded.amplitude.data()[i]) < lit_amplitude) continue;
    ++quality.lit;
    if (fate == PixelFate::kDecoded) ++decoded_and_lit;
  }
  quality.coverage = quality.lit == 0 ? 0.0 : static_cast<double>(decoded_and_lit) / quality.lit;

  std::vector<double> residuals;
  int gross = 0;
  std::vector<Sample> samples;
  for (int top = 0; top < decoded.fate.height(); top += kTilePx) {
    for (int left = 0; left < decoded.fate.width(); left += kTilePx) {
      samples.clear();
      for (int y = top; y < std::min(top + kTilePx, decoded.fate.height()); ++y) {
        for (int x = left; x < std::min(left + kTilePx, decoded.fate.width()); ++x) {
          if (*decoded.fate.at(x, y) != PixelFate::kDecoded) continue;
          const float* const position = decoded.position_px.at(x, y);
          samples.push_back({x - left - 0.5 * kTilePx, y - top - 0.5 * kTilePx, static_cast<double>(position[0]),
                             static_cast<double>(position[1])});
        }
      }
      if (samples.size() < kMinPixelsInTile) continue;
      const std::vector<double> distances = distances_in(samples);
      const auto near = std::count_if(distances.begin(), distances.end(), [](double d) { return d <= kGrossPx; });
      if (static_cast<double>(near) < kSmooth * static_cast<double>(samples.size())) continue;
      quality.judged += static_cast<int>(samples.size());
      gross += static_cast<int>(samples.size()) - static_cast<int>(near);
      for (const double distance : distances) {
        if (distance <= kGrossPx) residuals.push_back(distance);
      }
    }
  }
  if (quality.judged == 0) return quality;
  quality.gross = static_cast<double>(gross) / quality.judged;
  std::sort(residuals.begin(), residuals.end());
  quality.residual_median_px = residuals[residuals.size() / 2];
  quality.residual_p99_px = residuals[residuals.size() * 99 / 100];
  return quality;
}

}  // namespace cyclorama::structured_light
