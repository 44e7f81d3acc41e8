// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/split_reference.h"

#include "common/base/check.h"

namespace cyclorama::quality {
namespace {

/// Added to the square of the reference, so that dark pixels do not dominate.
constexpr double kDim = 0.01;

/// Returns the mean of term(i, reference) / (reference^2 + kDim) over all values.
template <typename Term>
double relative_mean(const SplitReference& reference, const Term& term) {
  const std::span<const float> a = reference.a.data();
  const std::span<const float> b = reference.b.data();
  CHECK(a.size() == b.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double r = 0.5 * (static_cast<double>(a[i]) + static_cast<double>(b[i]));
    sum += term(i) / (r * r + kDim);
  }
  return a.empty() ? 0.0 : sum / static_cast<double>(a.size());
}

}  // namespace

RadianceImage mean_of(const SplitReference& reference) {
  RadianceImage mean = reference.a;
  for (std::size_t i = 0; i < mean.data().size(); ++i) {
    mean.data()[i] = 0.5f * (reference.a.data()[i] + reference.b.data()[i]);
  }
  return mean;
}

double unbiased_relmse(const RadianceImage& picture, const SplitReference& reference) {
  CHECK(picture.data().size() == reference.a.data().size());
  return relative_mean(reference, [&](std::size_t i) {
    const auto p = static_cast<double>(picture.data()[i]);
    return (p - static_cast<double>(reference.a.data()[i])) * (p - static_cast<double>(reference.b.data()[i]));
  });
}

double half_relmse(const SplitReference& reference) {
  return relative_mean(reference, [&](std::size_t i) {
    const double difference = static_cast<double>(reference.a.data()[i]) - static_cast<double>(reference.b.data()[i]);
    return 0.5 * difference * difference;
  });
}

double mean_value(const RadianceImage& picture) {
  double sum = 0.0;
  for (const float value : picture.data()) sum += static_cast<double>(value);
  return sum / static_cast<double>(picture.data().size());
}

RadianceImage block_means(const RadianceImage& picture, int side) {
  RadianceImage blocks(picture.width() / side, picture.height() / side);
  for (int y = 0; y < blocks.height(); ++y) {
    for (int x = 0; x < blocks.width(); ++x) {
      for (int c = 0; c < RadianceImage::kChannels; ++c) {
        double sum = 0.0;
        for (int j = 0; j < side; ++j) {
          for (int i = 0; i < side; ++i) sum += static_cast<double>(picture.at(x * side + i, y * side + j)[c]);
        }
        blocks.at(x, y)[c] = static_cast<float>(sum / (side * side));
      }
    }
  }
  return blocks;
}

SplitReference block_means(const SplitReference& reference, int side) {
  return {block_means(reference.a, side), block_means(reference.b, side)};
}

}  // namespace cyclorama::quality
