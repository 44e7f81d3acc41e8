// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/film.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace cyclorama::render {
namespace {

template <typename Pixels>
void add_to(Pixels& to, const Pixels& from) {
  std::transform(to.data().begin(), to.data().end(), from.data().begin(), to.data().begin(), std::plus<>());
}

/// Combines two means, each weighted by its number of samples.
template <typename Pixels>
void blend_into(Pixels& to, const Pixels& from, const Image<std::int32_t, 1>& to_samples,
                const Image<std::int32_t, 1>& from_samples) {
  for (std::size_t i = 0; i < to_samples.data().size(); ++i) {
    const auto n = static_cast<float>(to_samples.data()[i]);
    const auto m = static_cast<float>(from_samples.data()[i]);
    if (m == 0.0f) continue;
    for (std::size_t c = 0; c < Pixels::kChannels; ++c) {
      float& value = to.data()[i * Pixels::kChannels + c];
      value = (value * n + from.data()[i * Pixels::kChannels + c] * m) / (n + m);
    }
  }
}

}  // namespace

Film::Film(int width, int height, bool with_features)
    : sum(width, height), square(width, height), samples(width, height) {
  if (with_features) {
    features = {RadianceImage(width, height), RadianceImage(width, height), ScalarImage(width, height)};
  }
}

void Film::add(const Film& other) {
  CHECK(other.width() == width() && other.height() == height());
  CHECK(other.features.albedo.empty() == features.albedo.empty());
  CHECK(other.depth.width() == depth.width() && other.depth.height() == depth.height());
  if (!features.albedo.empty()) {
    blend_into(features.albedo, other.features.albedo, samples, other.samples);
    blend_into(features.normal, other.features.normal, samples, other.samples);
    blend_into(features.distance, other.features.distance, samples, other.samples);
  }
  add_to(sum, other.sum);
  add_to(square, other.square);
  add_to(samples, other.samples);
  for (std::size_t i = 0; i < depth.data().size(); ++i) {
    depth.data()[i] = std::max(depth.data()[i], other.depth.data()[i]);
  }
}

RadianceImage Film::mean() const {
  RadianceImage mean = sum;
  for (std::size_t i = 0; i < samples.data().size(); ++i) {
    const float scale = 1.0f / static_cast<float>(std::max(1, samples.data()[i]));
    for (std::size_t c = 0; c < 3; ++c) mean.data()[3 * i + c] *= scale;
  }
  return mean;
}

ScalarImage Film::variance() const {
  ScalarImage variance(width(), height(), std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < samples.data().size(); ++i) {
    const auto n = static_cast<double>(samples.data()[i]);
    if (n < 2.0) continue;
    const float* const rgb = &sum.data()[3 * i];
    const double mean = (0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
                         0.0722 * static_cast<double>(rgb[2])) /
                        n;
    const double spread = std::max(0.0, static_cast<double>(square.data()[i]) / n - mean * mean);
    variance.data()[i] = static_cast<float>(spread / (n - 1.0));
  }
  return variance;
}

}  // namespace cyclorama::render
