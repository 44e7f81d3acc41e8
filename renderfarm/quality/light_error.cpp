// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/light_error.h"

#include "renderfarm/quality/comparable.h"

namespace cyclorama::quality {
namespace {

template <typename Weight>
double weighted_mean(const RadianceImage& picture, const RadianceImage& reference, const Weight& weight) {
  double sum = 0.0;
  for (std::size_t i = 0; i < picture.data().size(); ++i) {
    const auto r = static_cast<double>(reference.data()[i]);
    const double difference = static_cast<double>(picture.data()[i]) - r;
    sum += difference * difference * weight(r);
  }
  return sum / static_cast<double>(picture.data().size());
}

}  // namespace

Result<double> mean_squared_error(const RadianceImage& picture, const RadianceImage& reference) {
  TRY(check_comparable(picture, reference));
  return weighted_mean(picture, reference, [](double) { return 1.0; });
}

Result<double> relative_squared_error(const RadianceImage& picture, const RadianceImage& reference, double floor) {
  CHECK(floor > 0.0);
  TRY(check_comparable(picture, reference));
  return weighted_mean(picture, reference, [floor](double r) { return 1.0 / (r * r + floor); });
}

}  // namespace cyclorama::quality
