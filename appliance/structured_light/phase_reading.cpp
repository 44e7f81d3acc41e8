// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/phase_reading.h"

#include <cmath>
#include <numbers>

namespace cyclorama::structured_light {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
/// Lower bound of the sigma, as a fraction of the period: the error that the responses of projector and camera cause.
constexpr double kModelShare = 1e-3;

}  // namespace

void PhaseReading::add(int step, const Photo& photo) {
  if (sums_.empty()) sums_ = Image<float, 2>(photo.width(), photo.height());
  const auto cosine = static_cast<float>(std::cos(kTurn * step / steps_));
  const auto sine = static_cast<float>(std::sin(kTurn * step / steps_));
  for (std::size_t i = 0; i < photo.data().size(); ++i) {
    sums_.data()[2 * i] += cosine * photo.data()[i];
    sums_.data()[2 * i + 1] += sine * photo.data()[i];
  }
  ++seen_;
}

void PhaseReading::refine(double noise, AxisPositions* positions) const {
  for (std::size_t i = 0; i < positions->sigma_px.data().size(); ++i) {
    float& sigma = positions->sigma_px.data()[i];
    if (sigma < 0.0f) continue;
    const auto cosine = static_cast<double>(sums_.data()[2 * i]);
    const auto sine = static_cast<double>(sums_.data()[2 * i + 1]);
    const double strength = 2.0 / steps_ * std::hypot(cosine, sine);
    const double phase_sigma = noise * std::sqrt(2.0 / steps_) / std::max(strength, 1e-9);
    // The phase is lost in noise, so the bits' position is kept.
    if (phase_sigma > 0.2) continue;
    const double within = std::atan2(sine, cosine) / kTurn * period_px_;
    float& position = positions->position_px.data()[i];
    const double periods = std::round((static_cast<double>(position) - within) / period_px_);
    const double pixel = within + periods * period_px_;
    const double open = std::abs(pixel - static_cast<double>(position));
    if (open > 0.25 * period_px_) {
      sigma = -1.0f;
      continue;
    }
    const double position_sigma = std::hypot(phase_sigma / kTurn, kModelShare) * period_px_;
    if (position_sigma >= static_cast<double>(sigma)) continue;
    sigma = static_cast<float>(position_sigma);
    position = static_cast<float>(pixel);
  }
}

}  // namespace cyclorama::structured_light
