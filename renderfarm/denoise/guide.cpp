// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/guide.h"

#include <algorithm>
#include <cmath>

#include "common/base/vector_clones.h"
#include "renderfarm/denoise/box_sum.h"

namespace cyclorama::denoise {
namespace {

// These bounds keep squares and their sums within the range of float.
constexpr float kMaxRadiance = 1e12f;
constexpr float kMaxVariance = 1e30f;
constexpr float kMaxDistance = 1e15f;
constexpr float kMinFootprint = 1e-20f;

/// Lower bound of the albedo by which light is divided, so that black surfaces do not amplify it excessively.
constexpr float kMinAlbedo = 0.01f;

constexpr int kFireflyRadius = 2;
constexpr int kVarianceRadius = 1;
static_assert(kGuideReachPx == kFireflyRadius + kVarianceRadius);

/// Maximum excess of a pixel over the mean of its neighbours, in standard deviations of the neighbours.
constexpr float kFireflyDeviations = 4.0f;
/// If the excess is more than this many standard errors of the pixel, the pixel is a highlight and not a firefly.
constexpr float kSureErrors = 3.0f;

/// Tolerance in variances at few samples, and the number of samples at which it is halved. A pixel's samples are
/// stratified, so their spread increasingly overestimates the error; the tolerance falls as the samples converge.
/// converge.
constexpr float kTolerance = 64.0f;
constexpr float kToleranceHalved = 8.0f;

/// Clamps to [-max, max]; NaN and infinities become 0.
inline float finite(float value, float max) {
  const float cut = value < max ? value : max;
  const float whole = cut > -max ? cut : -max;
  return value - value == 0.0f ? whole : 0.0f;
}

inline float divisor(float albedo) {
  const float a = finite(albedo, kMaxRadiance);
  return a > kMinAlbedo ? a : kMinAlbedo;
}

/// One row of an interleaved image, separated into three planes.
struct Row3 {
  explicit Row3(int count) : x(static_cast<std::size_t>(count)), y(x.size()), z(x.size()) {}
  std::vector<float> x, y, z;
};

CYCLORAMA_VECTOR_CLONES
void split(int count, const float* __restrict from, float* __restrict x, float* __restrict y, float* __restrict z) {
  for (int i = 0; i < count; ++i) {
    x[i] = from[3 * i];
    y[i] = from[3 * i + 1];
    z[i] = from[3 * i + 2];
  }
}

CYCLORAMA_VECTOR_CLONES
void weigh(int count, const std::int32_t* __restrict samples, const float* __restrict red,
           const float* __restrict green, const float* __restrict blue, float* __restrict weight,
           float* __restrict per_sample) {
  for (int i = 0; i < count; ++i) {
    const float sum = red[i] + green[i] + blue[i];
    const bool valid = (samples[i] > 0) & (sum - sum == 0.0f);
    weight[i] = valid ? 1.0f : 0.0f;
    per_sample[i] = valid ? 1.0f / static_cast<float>(samples[i]) : 0.0f;
  }
}

CYCLORAMA_VECTOR_CLONES
void demodulate(int count, const float* __restrict per_sample, const float* __restrict albedo, float share,
                float* __restrict light, float* __restrict raw_luminance, float* __restrict luminance) {
  for (int i = 0; i < count; ++i) {
    const float raw = per_sample[i] > 0.0f ? finite(light[i] * per_sample[i], kMaxRadiance) : 0.0f;
    light[i] = raw / divisor(albedo[i]);
    raw_luminance[i] += share * raw;
    luminance[i] += share * light[i];
  }
}

/// Computes the variance of the mean of each pixel's samples; 0 for a single sample.
CYCLORAMA_VECTOR_CLONES
void sample_variance(int count, const float* __restrict per_sample, const float* __restrict square,
                     const float* __restrict raw, const float* __restrict luminance, float* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    const float spread = finite(square[i] * per_sample[i], kMaxVariance) - raw[i] * raw[i];
    const float ratio = luminance[i] / (raw[i] > 1e-20f ? raw[i] : 1e-20f);
    const float of_mean = spread > 0.0f ? spread * per_sample[i] / (1.0f - per_sample[i]) * ratio * ratio : 0.0f;
    variance[i] = per_sample[i] < 1.0f ? finite(of_mean, kMaxVariance) : 0.0f;
  }
}

CYCLORAMA_VECTOR_CLONES
void sanitise(int count, float max, float* values) {
  for (int i = 0; i < count; ++i) values[i] = finite(values[i], max);
}

CYCLORAMA_VECTOR_CLONES
void put_at_distance(int count, float radians_per_px, const float* __restrict distance, float* __restrict x,
                     float* __restrict y, float* __restrict z, float* __restrict per_footprint) {
  for (int i = 0; i < count; ++i) {
    const float d = finite(distance[i], kMaxDistance);
    const float footprint = d * radians_per_px;
    x[i] *= d;
    y[i] *= d;
    z[i] *= d;
    per_footprint[i] = 1.0f / (footprint > kMinFootprint ? footprint : kMinFootprint);
  }
}

CYCLORAMA_VECTOR_CLONES
void dot(int count, const float* __restrict ax, const float* __restrict ay, const float* __restrict az,
         const float* __restrict bx, const float* __restrict by, const float* __restrict bz, float* __restrict ret) {
  for (int i = 0; i < count; ++i) ret[i] = ax[i] * bx[i] + ay[i] * by[i] + az[i] * bz[i];
}

void split_surfaces(const render::Film& film, const PixelRays& rays, const PixelRect& part, Guide* ret) {
  const int width = part.width;
  const auto radians_per_px = static_cast<float>(rays.radians_per_px);
  for (int y = 0; y < part.height; ++y) {
    float* const normal[] = {ret->normal_x.at(0, y), ret->normal_y.at(0, y), ret->normal_z.at(0, y)};
    float* const place[] = {ret->place_x.at(0, y), ret->place_y.at(0, y), ret->place_z.at(0, y)};
    split(width, film.features.normal.at(part.x, part.y + y), normal[0], normal[1], normal[2]);
    for (float* const axis : normal) sanitise(width, 1.0f, axis);
    split(width, rays.directions.at(part.x, part.y + y), place[0], place[1], place[2]);
    put_at_distance(width, radians_per_px, film.features.distance.at(part.x, part.y + y), place[0], place[1], place[2],
                    ret->per_footprint.at(0, y));
    dot(width, normal[0], normal[1], normal[2], place[0], place[1], place[2], ret->plane_offset.at(0, y));
  }
}

CYCLORAMA_VECTOR_CLONES
void multiply(std::size_t count, const float* __restrict a, const float* __restrict b, float* __restrict ret) {
  for (std::size_t i = 0; i < count; ++i) ret[i] = a[i] * b[i];
}

CYCLORAMA_VECTOR_CLONES
void find_fireflies(std::size_t size, const float* __restrict value, const float* __restrict variance,
                    const float* __restrict weight, const float* __restrict per_sample, const float* __restrict count,
                    const float* __restrict sum, const float* __restrict square, float* __restrict scale) {
  for (std::size_t i = 0; i < size; ++i) {
    const float others = count[i] - weight[i];
    const float per_other = 1.0f / (others > 1.0f ? others : 1.0f);
    const float own = value[i];
    const float mean = (sum[i] - own) * per_other;
    const float spread = (square[i] - own * own) * per_other - mean * mean;
    const float limit = mean + kFireflyDeviations * std::sqrt(spread > 0.0f ? spread : 0.0f);
    const float excess = own - limit;
    const bool unsure = (per_sample[i] == 1.0f) | (kSureErrors * kSureErrors * variance[i] >= excess * excess);
    scale[i] = (others > 0.0f) & (excess > 0.0f) & unsure ? (limit > 0.0f ? limit : 0.0f) / own : 1.0f;
  }
}

CYCLORAMA_VECTOR_CLONES
void scale_by(std::size_t count, const float* __restrict scale, float* __restrict values) {
  for (std::size_t i = 0; i < count; ++i) values[i] *= scale[i];
}

CYCLORAMA_VECTOR_CLONES
void pool(std::size_t size, const float* __restrict per_sample, const float* __restrict count,
          const float* __restrict sum, const float* __restrict square, const float* __restrict own_sum,
          const float* __restrict own_count, float* __restrict variance, float* __restrict tolerance) {
  for (std::size_t i = 0; i < size; ++i) {
    const float per_one = 1.0f / (count[i] > 1.0f ? count[i] : 1.0f);
    const float mean = sum[i] * per_one;
    const float spread = (square[i] * per_one - mean * mean) / (1.0f - (per_one < 1.0f ? per_one : 0.0f));
    const float among = spread > 0.0f ? spread : 0.0f;
    const float within = own_sum[i] / (own_count[i] > 1.0f ? own_count[i] : 1.0f);
    variance[i] = per_sample[i] == 1.0f ? among : within;
    const float few = kToleranceHalved * per_sample[i];
    tolerance[i] = kTolerance * few / (1.0f + few);
  }
}

CYCLORAMA_VECTOR_CLONES
void mark_several(std::size_t count, const float* __restrict per_sample, float* __restrict ret) {
  for (std::size_t i = 0; i < count; ++i) ret[i] = (per_sample[i] > 0.0f) & (per_sample[i] < 1.0f) ? 1.0f : 0.0f;
}

CYCLORAMA_VECTOR_CLONES
void times_albedo(int count, const float* __restrict red, const float* __restrict green, const float* __restrict blue,
                  const float* __restrict albedo, float* __restrict rgb) {
  for (int i = 0; i < count; ++i) {
    rgb[3 * i] = red[i] * divisor(albedo[3 * i]);
    rgb[3 * i + 1] = green[i] * divisor(albedo[3 * i + 1]);
    rgb[3 * i + 2] = blue[i] * divisor(albedo[3 * i + 2]);
  }
}

}  // namespace

void LightPlanes::reshape(int width, int height) {
  for (Plane* const plane : {&red, &green, &blue, &luminance, &variance}) plane->reshape(width, height);
}

void Guide::reshape(int width, int height) {
  light.reshape(width, height);
  for (Plane* const plane : {&weight, &tolerance, &normal_x, &normal_y, &normal_z, &place_x, &place_y, &place_z,
                             &plane_offset, &per_footprint}) {
    plane->reshape(width, height);
  }
}

void GuideMaker::make(const render::Film& film, const PixelRays& rays, const PixelRect& part, Guide* ret) {
  CHECK(film.features.albedo.width() == film.width() && film.features.albedo.height() == film.height());
  CHECK(rays.directions.width() == film.width() && rays.directions.height() == film.height());
  ret->reshape(part.width, part.height);
  split_light(film, part, ret);
  split_surfaces(film, rays, part, ret);
  tame_fireflies(ret);
  pool_variance(ret);
}

void GuideMaker::split_light(const render::Film& film, const PixelRect& part, Guide* ret) {
  const int width = part.width;
  Row3 albedo(width);
  std::vector<float> raw(static_cast<std::size_t>(width));
  LightPlanes& light = ret->light;
  std::fill(light.luminance.data().begin(), light.luminance.data().end(), 0.0f);
  per_sample_.reshape(width, part.height);
  for (int y = 0; y < part.height; ++y) {
    const int from = part.y + y;
    float* const channels[] = {light.red.at(0, y), light.green.at(0, y), light.blue.at(0, y)};
    const float* const albedos[] = {albedo.x.data(), albedo.y.data(), albedo.z.data()};
    constexpr float kShares[] = {0.2126f, 0.7152f, 0.0722f};
    split(width, film.sum.at(part.x, from), channels[0], channels[1], channels[2]);
    split(width, film.features.albedo.at(part.x, from), albedo.x.data(), albedo.y.data(), albedo.z.data());
    weigh(width, film.samples.at(part.x, from), channels[0], channels[1], channels[2], ret->weight.at(0, y),
          per_sample_.at(0, y));
    std::fill(raw.begin(), raw.end(), 0.0f);
    for (int c = 0; c < 3; ++c) {
      demodulate(width, per_sample_.at(0, y), albedos[c], kShares[c], channels[c], raw.data(),
                 light.luminance.at(0, y));
    }
    sample_variance(width, per_sample_.at(0, y), film.square.at(part.x, from), raw.data(), light.luminance.at(0, y),
                    light.variance.at(0, y));
  }
}

void GuideMaker::sum_moments(const Guide& guide, int radius) {
  const Plane& value = guide.light.luminance;
  scale_.reshape(value.width(), value.height());
  multiply(scale_.data().size(), value.data().data(), value.data().data(), scale_.data().data());
  box_sum(guide.weight, radius, &scratch_, &around_.count);
  box_sum(value, radius, &scratch_, &around_.sum);
  box_sum(scale_, radius, &scratch_, &around_.square);
}

void GuideMaker::tame_fireflies(Guide* guide) {
  LightPlanes& light = guide->light;
  sum_moments(*guide, kFireflyRadius);
  const std::size_t size = scale_.data().size();
  find_fireflies(size, light.luminance.data().data(), light.variance.data().data(), guide->weight.data().data(),
                 per_sample_.data().data(), around_.count.data().data(), around_.sum.data().data(),
                 around_.square.data().data(), scale_.data().data());
  // Variance appears twice, because it is scaled by the square.
  for (Plane* const plane :
       {&light.red, &light.green, &light.blue, &light.luminance, &light.variance, &light.variance}) {
    scale_by(size, scale_.data().data(), plane->data().data());
  }
}

void GuideMaker::pool_variance(Guide* guide) {
  LightPlanes& light = guide->light;
  sum_moments(*guide, kVarianceRadius);
  const std::size_t size = scale_.data().size();
  mark_several(size, per_sample_.data().data(), scale_.data().data());
  box_sum(scale_, kVarianceRadius, &scratch_, &own_count_);
  box_sum(light.variance, kVarianceRadius, &scratch_, &own_sum_);
  pool(size, per_sample_.data().data(), around_.count.data().data(), around_.sum.data().data(),
       around_.square.data().data(), own_sum_.data().data(), own_count_.data().data(), light.variance.data().data(),
       guide->tolerance.data().data());
}

void remodulate(const LightPlanes& light, const PixelRect& part, const RadianceImage& albedo, int to_x, int to_y,
                RadianceImage* ret_picture) {
  for (int y = 0; y < part.height; ++y) {
    times_albedo(part.width, light.red.at(part.x, part.y + y), light.green.at(part.x, part.y + y),
                 light.blue.at(part.x, part.y + y), albedo.at(to_x, to_y + y), ret_picture->at(to_x, to_y + y));
  }
}

}  // namespace cyclorama::denoise
