// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/light_plane.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace cyclorama::healing {
namespace {

/// Averages `light_at(x, y)` over blocks; drops incomplete blocks at the right and at the bottom.
template <typename LightAt>
LightPlane shrunk(int width, int height, int factor, const LightAt& light_at) {
  CHECK(factor >= 1);
  LightPlane plane{factor, Image<float, 1>(width / factor, height / factor)};
  const float share = 1.0f / static_cast<float>(factor * factor);
  for (int y = 0; y < plane.height(); ++y) {
    float* to = plane.light.at(0, y);
    for (int row = 0; row < factor; ++row) {
      for (int x = 0; x < plane.width(); ++x) {
        float sum = 0.0f;
        for (int column = 0; column < factor; ++column) sum += light_at(x * factor + column, y * factor + row);
        to[x] += share * sum;
      }
    }
  }
  return plane;
}

}  // namespace

float LightPlane::at(float x, float y) const {
  const float left = std::floor(x - 0.5f);
  const float top = std::floor(y - 0.5f);
  const float fx = x - 0.5f - left;
  const float fy = y - 0.5f - top;
  if (!(left >= -1.0f && top >= -1.0f && left < static_cast<float>(width()) && top < static_cast<float>(height())))
    return 0.0f;
  const int x0 = static_cast<int>(left);
  const int y0 = static_cast<int>(top);
  if (x0 >= 0 && y0 >= 0 && x0 + 1 < width() && y0 + 1 < height()) {
    const float* upper = light.at(x0, y0);
    const float* lower = upper + width();
    const float above = upper[0] + fx * (upper[1] - upper[0]);
    return above + fy * (lower[0] + fx * (lower[1] - lower[0]) - above);
  }
  const auto one = [&](int xi, int yi) {
    return xi < 0 || yi < 0 || xi >= width() || yi >= height() ? 0.0f : *light.at(xi, yi);
  };
  return (1.0f - fy) * ((1.0f - fx) * one(x0, y0) + fx * one(x0 + 1, y0)) +
         fy * ((1.0f - fx) * one(x0, y0 + 1) + fx * one(x0 + 1, y0 + 1));
}

LightPlane shone_light(const RgbImage& picture, const calibration::ShowProjector& projector, int factor) {
  std::array<calibration::CodeLight, 3> grey = projector.light;
  for (std::size_t c = 0; c < grey.size(); ++c) {
    for (float& light : grey[c]) light *= projector.grey[c];
  }
  return shrunk(picture.width(), picture.height(), factor, [&](int x, int y) {
    const std::uint8_t* code = picture.at(x, y);
    return grey[0][code[0]] + grey[1][code[1]] + grey[2][code[2]];
  });
}

LightPlane seen_light(const GreyImage& picture, const calibration::ShowCamera& camera, int factor, double* ret_blown) {
  const auto blown = std::ranges::count_if(picture.data(), [](std::uint8_t code) { return code >= 254; });
  *ret_blown = picture.empty() ? 0.0 : static_cast<double>(blown) / static_cast<double>(picture.data().size());
  return shrunk(picture.width(), picture.height(), factor,
                [&](int x, int y) { return camera.light[*picture.at(x, y)]; });
}

void soften(LightPlane* plane) {
  const int width = plane->width();
  const int height = plane->height();
  if (width < 2 || height < 2) return;
  std::vector<float> above(static_cast<std::size_t>(width));
  std::vector<float> here(static_cast<std::size_t>(width));
  const auto across = [&](int y, std::vector<float>* to) {
    const float* row = plane->light.at(0, y);
    for (int x = 1; x + 1 < width; ++x)
      (*to)[static_cast<std::size_t>(x)] = .25f * (row[x - 1] + row[x + 1]) + .5f * row[x];
    to->front() = .75f * row[0] + .25f * row[1];
    to->back() = .75f * row[width - 1] + .25f * row[width - 2];
  };
  std::vector<float> below(static_cast<std::size_t>(width));
  across(0, &here);
  above = here;
  for (int y = 0; y < height; ++y) {
    if (y + 1 < height) {
      across(y + 1, &below);
    } else {
      below = here;
    }
    float* row = plane->light.at(0, y);
    for (std::size_t x = 0; x < here.size(); ++x) row[x] = .25f * (above[x] + below[x]) + .5f * here[x];
    std::swap(above, here);
    std::swap(here, below);
  }
}

LightPlane halved(const LightPlane& plane) {
  LightPlane soft = plane;
  soften(&soft);
  // Blocks of 2×2 pixels keep the picture's corners in place, as the definition of `factor` requires.
  LightPlane half = shrunk(soft.width(), soft.height(), 2, [&](int x, int y) { return *soft.light.at(x, y); });
  half.factor = 2 * plane.factor;
  return half;
}

}  // namespace cyclorama::healing
