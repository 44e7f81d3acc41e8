// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/camera_pipeline.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/check.h"
#include "common/image/jpeg.h"

namespace cyclorama::simulated {
namespace {

/// Differences of more codes of 8 bits than these are taken for edges.
constexpr float kNoise = 8.0f;

/// Mean of a pixel's neighbours, itself included; the border is continued.
std::vector<float> means_of(const std::vector<float>& plane, int width, int height) {
  std::vector<float> means(plane.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float sum = 0.0f;
      for (int dy = -1; dy <= 1; ++dy) {
        const auto row = static_cast<std::size_t>(std::clamp(y + dy, 0, height - 1)) * static_cast<std::size_t>(width);
        for (int dx = -1; dx <= 1; ++dx) sum += plane[row + static_cast<std::size_t>(std::clamp(x + dx, 0, width - 1))];
      }
      means[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = sum / 9.0f;
    }
  }
  return means;
}

void filter(const CameraPipeline& pipeline, int width, int height, std::vector<float>* plane) {
  if (pipeline.noise_reduction > 0.0) {
    const std::vector<float> means = means_of(*plane, width, height);
    for (std::size_t i = 0; i < plane->size(); ++i) {
      const float difference = means[i] - (*plane)[i];
      if (std::abs(difference) < kNoise) (*plane)[i] += static_cast<float>(pipeline.noise_reduction) * difference;
    }
  }
  if (pipeline.sharpening > 0.0) {
    const std::vector<float> means = means_of(*plane, width, height);
    for (std::size_t i = 0; i < plane->size(); ++i)
      (*plane)[i] += static_cast<float>(pipeline.sharpening) * ((*plane)[i] - means[i]);
  }
}

std::uint8_t rounded(float code) { return static_cast<std::uint8_t>(std::clamp(code + 0.5f, 0.0f, 255.0f)); }

template <int Channels>
void apply_to(const CameraPipeline& pipeline, Image<std::uint16_t, Channels>* codes, int max_code) {
  if (pipeline.is_plain()) return;
  const int width = codes->width();
  const int height = codes->height();
  const float scale = 255.0f / static_cast<float>(max_code);
  RgbImage picture(width, height);
  std::vector<float> plane(codes->data().size() / Channels);
  for (std::size_t c = 0; c < Channels; ++c) {
    for (std::size_t i = 0; i < plane.size(); ++i)
      plane[i] = scale * static_cast<float>(codes->data()[Channels * i + c]);
    filter(pipeline, width, height, &plane);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      for (std::size_t to = Channels == 1 ? 0 : c; to < (Channels == 1 ? 3 : c + 1); ++to)
        picture.data()[3 * i + to] = rounded(plane[i]);
    }
  }
  if (pipeline.jpeg_quality > 0) {
    const auto jpeg = JpegEncoder().encode(picture, {.quality = pipeline.jpeg_quality});
    CHECK(jpeg.has_value());
    auto decoded = JpegDecoder().decode(*jpeg, picture.data().size());
    CHECK(decoded.has_value());
    picture = *std::move(decoded);
  }
  for (std::size_t i = 0; i < codes->data().size(); ++i) {
    const std::uint8_t code = picture.data()[Channels == 1 ? 3 * i + 1 : i];
    codes->data()[i] = static_cast<std::uint16_t>(std::lround(static_cast<float>(code) / scale));
  }
}

}  // namespace

void CameraPipeline::apply(Image<std::uint16_t, 1>* codes, int max_code) const { apply_to(*this, codes, max_code); }
void CameraPipeline::apply(Image<std::uint16_t, 3>* codes, int max_code) const { apply_to(*this, codes, max_code); }

}  // namespace cyclorama::simulated
