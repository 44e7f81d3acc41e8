// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/true_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama::simulated {
namespace {

constexpr std::size_t kSteps = 1u << 16;  // Steps of the amplifier's table.
constexpr std::size_t kQuantiles = 1u << 14;

std::vector<float> make_quantiles() {
  // Computes the upper half of the quantiles by Newton's method, each started from the previous one. The lower half
  // follows by symmetry; all are scaled to variance 1.
  std::vector<double> half;
  double x = 0.0;
  for (std::size_t i = kQuantiles / 2; i < kQuantiles; ++i) {
    const double p = (static_cast<double>(i) + 0.5) / kQuantiles;
    for (int step = 0; step < 20; ++step) {
      const double off = 0.5 * std::erfc(-x / std::numbers::sqrt2) - p;
      const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
      x -= off / density;
      if (std::abs(off) < 1e-15) break;
    }
    half.push_back(x);
  }
  double variance = 0.0;
  for (const double value : half) variance += 2.0 * value * value / kQuantiles;
  std::vector<float> quantiles;
  for (std::size_t i = half.size(); i-- > 0;) quantiles.push_back(static_cast<float>(-half[i] / std::sqrt(variance)));
  for (const double value : half) quantiles.push_back(static_cast<float>(value / std::sqrt(variance)));
  return quantiles;
}

}  // namespace

std::uint64_t mixed(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15u;
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9u;
  number = (number ^ (number >> 27)) * 0x94d049bb133111ebu;
  return number ^ (number >> 31);
}

std::span<const float> normal_quantiles() {
  static const std::vector<float> quantiles = make_quantiles();
  return quantiles;
}

TrueSensor::TrueSensor(const TrueCamera& camera)
    : full_well_e_(static_cast<float>(camera.full_well_e)),
      read_variance_(static_cast<float>(camera.read_noise_e * camera.read_noise_e)),
      has_shot_noise_(camera.has_shot_noise),
      pedestal_(static_cast<float>(camera.pedestal)),
      max_code_(static_cast<float>((1 << camera.bits) - 1)),
      response_(camera.response) {
  for (std::size_t i = 0; i <= kSteps; ++i) {
    codes_.push_back(max_code_ * static_cast<float>(response_.at(static_cast<double>(i) / kSteps)));
  }
  codes_.push_back(codes_.back());
}

double TrueSensor::expected_code(double electrons) const {
  return static_cast<double>(max_code_) *
         response_.at(electrons / static_cast<double>(full_well_e_) + static_cast<double>(pedestal_));
}

void TrueSensor::read_row(std::span<const float> electrons, std::uint64_t stream, std::uint16_t* codes,
                          std::size_t stride) const {
  const std::span<const float> quantiles = normal_quantiles();
  const bool is_noisy = has_shot_noise_ || read_variance_ > 0.0f;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < electrons.size(); ++i) {
    float e = electrons[i];
    if (is_noisy) {
      if (i % 4 == 0) bits = mixed(stream * 0x100000001b3u + i);
      // A normal deviate approximates the Poisson distribution well enough above about twenty electrons.
      const float variance = (has_shot_noise_ ? std::max(e, 0.0f) : 0.0f) + read_variance_;
      e += std::sqrt(variance) * quantiles[bits & (kQuantiles - 1)];
      bits >>= 16;
    }
    const float x = std::clamp(e / full_well_e_ + pedestal_, 0.0f, 1.0f) * static_cast<float>(kSteps);
    const auto step = static_cast<std::size_t>(x);
    const float part = x - static_cast<float>(step);
    codes[i * stride] = static_cast<std::uint16_t>(codes_[step] + part * (codes_[step + 1] - codes_[step]) + 0.5f);
  }
}

}  // namespace cyclorama::simulated
