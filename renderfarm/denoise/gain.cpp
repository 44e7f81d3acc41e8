// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/gain.h"

#include <fmt/format.h>

#include <vector>

namespace cyclorama::denoise {

Result<DenoiseGain> measure_gain(const RadianceImage& reference, std::span<const render::Film> films,
                                 const DenoiseFilm& denoise) {
  const auto refuse = [](std::string why) { return Error(ErrorCode::kInvalidArgument, std::move(why)); };
  if (films.size() < 2) return refuse(fmt::format("measuring bias needs at least 2 films, not {}", films.size()));
  const std::span<const float> truth = reference.data();
  const auto weight = [&](std::size_t i) {
    const auto value = static_cast<double>(truth[i]);
    return 1.0 / ((value * value + 0.01) * static_cast<double>(truth.size()));
  };
  const auto count = static_cast<double>(films.size());
  DenoiseGain gain;
  std::vector<double> mean(truth.size());
  std::vector<double> square(truth.size());
  for (const render::Film& film : films) {
    if (film.width() != reference.width() || film.height() != reference.height()) {
      return refuse("the films and the reference differ in size");
    }
    const RadianceImage before = film.mean();
    const RadianceImage after = denoise(film);
    CHECK(after.data().size() == truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const double error = static_cast<double>(before.data()[i]) - static_cast<double>(truth[i]);
      const double left = static_cast<double>(after.data()[i]) - static_cast<double>(truth[i]);
      gain.mse_before += weight(i) * error * error / count;
      mean[i] += left / count;
      square[i] += left * left / count;
    }
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double variance = (square[i] - mean[i] * mean[i]) * count / (count - 1.0);
    gain.mse_after += weight(i) * square[i];
    gain.variance_after += weight(i) * variance;
    gain.bias2 += weight(i) * (mean[i] * mean[i] - variance / count);
  }
  return gain;
}

}  // namespace cyclorama::denoise
