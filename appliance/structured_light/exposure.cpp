// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/exposure.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace cyclorama::structured_light {
namespace {

constexpr double kSaturated = 0.98;
constexpr float kLitGain = 0.02f;
constexpr double kBrightLow = 0.6;
constexpr double kDimLow = 0.3;
constexpr double kBrightHigh = 0.9;
constexpr double kMaxSaturated = 0.005;
/// Divisor for the shortest exposure that was too bright, while there is no better sample.
constexpr double kStepDown = 4.0;
constexpr double kStepUp = 8.0;

bool is_too_bright(const ExposureSample& sample) {
  return sample.saturated > kMaxSaturated || sample.bright > kBrightHigh;
}

/// Clamps to the limits and rounds to whole periods if at least one fits.
ExposureTime allowed(ExposureTime wanted, const ExposureLimits& limits) {
  ExposureTime exposure = std::clamp(wanted, limits.shortest, limits.longest);
  const ExposureTime period = limits.projector_period;
  if (period.count() > 0.0 && exposure >= period) exposure = period * std::floor(exposure / period + 1e-9);
  return std::max(exposure, limits.shortest);
}

}  // namespace

ExposureSample exposure_sample(ExposureTime exposure, const Photo& white, const Photo& black) {
  ExposureSample sample;
  sample.exposure = exposure;
  std::vector<float> lit;
  const std::size_t count = std::min(white.data().size(), black.data().size());
  std::size_t saturated = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_saturated = static_cast<double>(white.data()[i]) >= kSaturated;
    if (!is_saturated && !(white.data()[i] - black.data()[i] >= kLitGain)) continue;
    lit.push_back(white.data()[i]);
    saturated += is_saturated ? 1 : 0;
  }
  if (lit.empty()) return sample;
  const auto position = std::min(lit.size() - 1, static_cast<std::size_t>(0.995 * static_cast<double>(lit.size())));
  const auto bright = lit.begin() + static_cast<std::ptrdiff_t>(position);
  std::nth_element(lit.begin(), bright, lit.end());
  sample.bright = static_cast<double>(*bright);
  sample.saturated = static_cast<double>(saturated) / static_cast<double>(lit.size());
  sample.lit = static_cast<double>(lit.size()) / static_cast<double>(count);
  return sample;
}

Result<ExposureAdvice> next_exposure(std::span<const ExposureSample> samples, const ExposureLimits& limits) {
  if (!(limits.shortest.count() > 0.0) || !(limits.longest >= limits.shortest) ||
      !(limits.projector_period.count() >= 0.0) || !std::isfinite(limits.longest.count()) ||
      !std::isfinite(limits.projector_period.count())) {
    return Error(ErrorCode::kInvalidArgument,
                 "exposures are longer than 0, and the longest is not shorter than the shortest");
  }
  for (const ExposureSample& sample : samples) {
    if (!(sample.exposure.count() > 0.0) || !std::isfinite(sample.exposure.count())) {
      return Error(ErrorCode::kInvalidArgument, "a photograph whose exposure is not known");
    }
  }
  if (samples.empty()) {
    return ExposureAdvice{allowed(ExposureTime(std::sqrt(limits.shortest.count() * limits.longest.count())), limits),
                          false};
  }
  const ExposureSample& newest = samples.back();
  // One period of tolerance, since exposures are whole periods.
  const bool is_long = newest.exposure >= limits.preferred_max - 1.001 * limits.projector_period;
  const bool may_be_dim = limits.preferred_max < limits.longest && is_long;
  if (!is_too_bright(newest) && newest.bright >= (may_be_dim ? kDimLow : kBrightLow))
    return ExposureAdvice{newest.exposure, true};

  // Light is proportional to exposure, so any sample that is neither black nor saturated gives the right exposure; the
  // brightest one is the most accurate.
  std::optional<ExposureTime> min_too_bright;
  const ExposureSample* best = nullptr;
  for (const ExposureSample& sample : samples) {
    if (is_too_bright(sample)) {
      min_too_bright = std::min(min_too_bright.value_or(sample.exposure), sample.exposure);
    } else if (sample.bright > 0.02 && (best == nullptr || sample.bright > best->bright)) {
      best = &sample;
    }
  }
  ExposureTime wanted = newest.exposure * kStepUp;
  if (best != nullptr) {
    wanted = best->exposure * (kBrightAim / best->bright);
    if (wanted > limits.preferred_max)
      wanted = std::max(limits.preferred_max, best->exposure * (kDimAim / best->bright));
    // Ambient light or a response curve can mislead, so an exposure that is known to be too bright is never tried
    // again.
    if (min_too_bright && wanted >= *min_too_bright) wanted = 0.5 * (best->exposure + *min_too_bright);
  } else if (min_too_bright) {
    wanted = *min_too_bright / kStepDown;
  }
  const ExposureTime next = allowed(wanted, limits);
  const bool was_tried = std::any_of(samples.begin(), samples.end(), [next](const ExposureSample& sample) {
    return std::abs(sample.exposure / next - 1.0) < 1e-6;
  });
  if (!was_tried) return ExposureAdvice{next, false};
  // Within the limits and whole periods there is no better exposure, so the sample at `next` is used if it is
  // acceptable.
  for (const ExposureSample& sample : samples) {
    if (std::abs(sample.exposure / next - 1.0) >= 1e-6) continue;
    if (is_too_bright(sample)) {
      return Error(ErrorCode::kBadData,
                   "too bright at the shortest exposure allowed: close the iris, or lower the camera's gain");
    }
    if (!(sample.bright > 0.08)) {
      return Error(ErrorCode::kBadData,
                   "too dark at the longest exposure allowed: open the iris, raise the camera's gain, or allow a "
                   "longer exposure");
    }
  }
  return ExposureAdvice{next, std::abs(newest.exposure / next - 1.0) < 1e-6};
}

}  // namespace cyclorama::structured_light
