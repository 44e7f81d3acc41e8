// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/a_trous.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/vector_clones.h"

namespace cyclorama::denoise {
namespace {

constexpr int kChunk = 256;  ///< Pixels per chunk; their sums fit into the L1 cache.

/// Inverse of the squared distance between unit normals at which the weight is 1/e: 10 degrees.
constexpr float kPerNormal = 32.0f;
/// Inverse of the distance from the pixel's tangent plane, in footprints per pixel of step, at which the weight is 1/e.
constexpr float kPerFootprint = 1.0f;

struct Sums {
  alignas(64) std::array<float, kChunk> red, green, blue, variance, weight;
};

/// A run of consecutive pixels, used as centres or as neighbours.
struct Run {
  Run(const Guide& guide, const LightPlanes& light, const Plane& inverse, int x, int y)
      : normal_x(guide.normal_x.at(x, y)),
        normal_y(guide.normal_y.at(x, y)),
        normal_z(guide.normal_z.at(x, y)),
        place_x(guide.place_x.at(x, y)),
        place_y(guide.place_y.at(x, y)),
        place_z(guide.place_z.at(x, y)),
        plane_offset(guide.plane_offset.at(x, y)),
        per_footprint(guide.per_footprint.at(x, y)),
        weight(guide.weight.at(x, y)),
        red(light.red.at(x, y)),
        green(light.green.at(x, y)),
        blue(light.blue.at(x, y)),
        luminance(light.luminance.at(x, y)),
        variance(light.variance.at(x, y)),
        per_tolerance(inverse.at(x, y)) {}
  const float *normal_x, *normal_y, *normal_z, *place_x, *place_y, *place_z, *plane_offset, *per_footprint, *weight;
  const float *red, *green, *blue, *luminance, *variance, *per_tolerance;
};

/// Approximates exp(-d); exactly 0 for d >= 8.
inline float falloff(float d) {
  const float root = 1.0f - 0.125f * d;
  const float positive = root > 0.0f ? root : 0.0f;
  const float two = positive * positive;
  const float four = two * two;
  return four * four;
}

CYCLORAMA_VECTOR_CLONES
void likeness(int count, const Run& p, const Run& q, float kernel, float per_step, float* __restrict weight) {
  const float* __restrict px = p.normal_x;
  const float* __restrict py = p.normal_y;
  const float* __restrict pz = p.normal_z;
  for (int i = 0; i < count; ++i) {
    const float dx = px[i] - q.normal_x[i];
    const float dy = py[i] - q.normal_y[i];
    const float dz = pz[i] - q.normal_z[i];
    const float off = px[i] * q.place_x[i] + py[i] * q.place_y[i] + pz[i] * q.place_z[i] - p.plane_offset[i];
    const float dl = p.luminance[i] - q.luminance[i];
    const float d = kPerNormal * (dx * dx + dy * dy + dz * dz) + std::fabs(off) * (per_step * p.per_footprint[i]) +
                    dl * dl * p.per_tolerance[i];
    weight[i] = kernel * falloff(d) * q.weight[i];
  }
}

CYCLORAMA_VECTOR_CLONES
void gather(int count, const Run& q, const float* __restrict weight, float* __restrict red, float* __restrict green,
            float* __restrict blue, float* __restrict variance, float* __restrict sum) {
  for (int i = 0; i < count; ++i) {
    const float w = weight[i];
    red[i] += w * q.red[i];
    green[i] += w * q.green[i];
    blue[i] += w * q.blue[i];
    variance[i] += w * w * q.variance[i];
    sum[i] += w;
  }
}

/// Offset of a neighbour and its weights.
struct Neighbour {
  int dx, dy;
  float kernel, per_step;
};

/// Adds the contribution of the neighbours at one offset to the sums of the `count` pixels from (x, y).
void add_neighbour(const Guide& guide, const LightPlanes& light, const Plane& per_tolerance, const Neighbour& neighbour,
                   int x, int y, int count, Sums* sums) {
  const int first = std::max(x, -neighbour.dx);
  const int last = std::min(x + count, guide.width() - neighbour.dx);
  if (first >= last || y + neighbour.dy < 0 || y + neighbour.dy >= guide.height()) return;
  const Run p(guide, light, per_tolerance, first, y);
  const Run q(guide, light, per_tolerance, first + neighbour.dx, y + neighbour.dy);
  alignas(64) std::array<float, kChunk> weight;
  likeness(last - first, p, q, neighbour.kernel, neighbour.per_step, weight.data());
  const int at = first - x;
  gather(last - first, q, weight.data(), sums->red.data() + at, sums->green.data() + at, sums->blue.data() + at,
         sums->variance.data() + at, sums->weight.data() + at);
}

CYCLORAMA_VECTOR_CLONES
void divide(int count, const Sums& sums, float* __restrict red, float* __restrict green, float* __restrict blue,
            float* __restrict luminance, float* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const float scale = sums.weight[at] > 0.0f ? 1.0f / sums.weight[at] : 0.0f;
    red[i] = sums.red[at] * scale;
    green[i] = sums.green[at] * scale;
    blue[i] = sums.blue[at] * scale;
    luminance[i] = 0.2126f * red[i] + 0.7152f * green[i] + 0.0722f * blue[i];
    variance[i] = sums.variance[at] * scale * scale;
  }
}

/// Computes the inverse of the squared difference of luminance at which the weight is 1/e. Without variance, only
/// pixels that are equal within float precision are averaged.
CYCLORAMA_VECTOR_CLONES
void invert_tolerance(std::size_t count, const float* __restrict variance, const float* __restrict luminance,
                      const float* __restrict tolerance, float* __restrict ret) {
  constexpr float kRounding = 1e-12f;
  for (std::size_t i = 0; i < count; ++i) {
    ret[i] = 1.0f / (tolerance[i] * variance[i] + kRounding * luminance[i] * luminance[i] + 1e-30f);
  }
}

}  // namespace

void filter_level(const Guide& guide, const LightPlanes& light, int step, Plane* scratch, LightPlanes* ret) {
  const int width = guide.width();
  Plane& per_tolerance = *scratch;
  per_tolerance.reshape(width, guide.height());
  ret->reshape(width, guide.height());
  invert_tolerance(per_tolerance.data().size(), light.variance.data().data(), light.luminance.data().data(),
                   guide.tolerance.data().data(), per_tolerance.data().data());
  Sums sums;
  for (int y = 0; y < guide.height(); ++y) {
    for (int x = 0; x < width; x += kChunk) {
      const int count = std::min(kChunk, width - x);
      sums = {};
      for (int row = -1; row <= 1; ++row) {
        for (int column = -1; column <= 1; ++column) {
          const float kernel = (row == 0 ? 2.0f : 1.0f) * (column == 0 ? 2.0f : 1.0f);
          const Neighbour neighbour{column * step, row * step, kernel, kPerFootprint / static_cast<float>(step)};
          add_neighbour(guide, light, per_tolerance, neighbour, x, y, count, &sums);
        }
      }
      divide(count, sums, ret->red.at(x, y), ret->green.at(x, y), ret->blue.at(x, y), ret->luminance.at(x, y),
             ret->variance.at(x, y));
    }
  }
}

}  // namespace cyclorama::denoise
