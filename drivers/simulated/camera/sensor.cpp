// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/camera/sensor.h"

#include <algorithm>
#include <random>

namespace cyclorama::simulated {
namespace {
constexpr std::size_t kNoiseValues = std::size_t{1} << 16;
}  // namespace

Sensor::Sensor(double noise_grey, std::uint32_t seed) : seed_(seed) {
  if (noise_grey <= 0.0) return;
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, static_cast<float>(noise_grey));
  noise_.resize(kNoiseValues);
  std::generate(noise_.begin(), noise_.end(), [&] { return normal(random); });
}

GreyImage Sensor::expose(const Image<float, 1>& light, double gain, std::uint64_t number) const {
  std::seed_seq seeds{seed_, static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(number >> 32)};
  std::mt19937 random(seeds);
  const auto by = static_cast<float>(gain);
  GreyImage grey(light.width(), light.height());
  for (int y = 0; y < grey.height(); ++y) {
    std::size_t next_noise = random() % kNoiseValues;
    for (int x = 0; x < grey.width(); ++x) {
      const float noise = noise_.empty() ? 0.0f : noise_[next_noise++ % kNoiseValues];
      *grey.at(x, y) = static_cast<std::uint8_t>(std::clamp(by * *light.at(x, y) + noise + 0.5f, 0.0f, 255.0f));
    }
  }
  return grey;
}

}  // namespace cyclorama::simulated
