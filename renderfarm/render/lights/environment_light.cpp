// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/environment_light.h"

#include <cmath>

#include "renderfarm/render/sky.h"

namespace cyclorama::render {
namespace {

constexpr float kMinSine = 1e-6f;  // Applies at the poles, where a whole row of texels is one direction.
constexpr float kMinCellShare = 1e-3f;

/// Returns true with probability first / (first + second) and rescales `u` to a fresh random number.
bool chooses_first(float first, float second, float* u) {
  const float share = first / (first + second);
  if (*u < share) {
    *u /= share;
    return true;
  }
  *u = std::min((*u - share) / (1.0f - share), 0x1.fffffep-1f);
  return false;
}

/// Samples [0, 1] with a pdf that is linear from a to b.
float sample_linear(float u, float a, float b) {
  if (a == b) return u;
  const float root = std::sqrt(a * a + u * (b * b - a * a));
  return std::min(u * (a + b) / (a + root), 1.0f);
}

float bilinear(const std::array<float, 4>& corners, float x, float y) {
  const float top = corners[0] + x * (corners[1] - corners[0]);
  const float bottom = corners[2] + x * (corners[3] - corners[2]);
  return top + y * (bottom - top);
}

/// row_top() and row_bottom() return the bounds of a row of cells between texel centres, in units of v. The first and
/// the last row are half as high as the others.
float row_top(int row, int height) {
  return std::max(0.0f, (static_cast<float>(row) - 0.5f) / static_cast<float>(height));
}
float row_bottom(int row, int height) {
  return std::min(1.0f, (static_cast<float>(row) + 0.5f) / static_cast<float>(height));
}

}  // namespace

EnvironmentLight::EnvironmentLight(const scene::Sky& sky, std::shared_ptr<const scene::EnvironmentMap> map)
    : sky_(sky), map_(std::move(map)) {
  if (map_ != nullptr && !map_->pixels.empty()) {
    measure_map();
  } else {
    map_ = nullptr;
    measure_sky();
  }
  shines_ = total_ > 0.0f && std::isfinite(total_);
}

void EnvironmentLight::add_to_faces(const Vec3& direction, float power) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float cosine = direction[static_cast<Eigen::Index>(axis)];
    faces_[2 * axis + (cosine < 0.0f ? 1 : 0)] += power * std::abs(cosine);
  }
}

void EnvironmentLight::measure_sky() {
  constexpr int kSteps = 32;
  const float horizon = luminance(sky_.horizon);
  upper_ = kPi * (horizon + luminance(sky_.zenith));
  total_ = upper_ + kPi * (horizon + luminance(sky_.ground));
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Vec2 u((static_cast<float>(i) + 0.5f) / kSteps, (static_cast<float>(j) + 0.5f) / kSteps);
      const Vec3 cap = uniform_cap(u, 2.0f);
      const Vec3 direction(cap.x(), cap.z(), cap.y());
      add_to_faces(direction, luminance(sky_radiance(sky_, direction)) * (4.0f * kPi / (kSteps * kSteps)));
    }
  }
}

void EnvironmentLight::measure_map() {
  const int width = map_->pixels.width();
  const int height = map_->pixels.height();
  Level cells{width, height + 1, {}};
  cells.sums.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height + 1));
  for (int row = 0; row <= height; ++row) {
    const float cap = std::cos(kPi * row_top(row, height)) - std::cos(kPi * row_bottom(row, height));
    const float solid_angle = cap * (2.0f * kPi / static_cast<float>(width));
    for (int column = 0; column < width; ++column) {
      cells.sums.push_back(solid_angle * bilinear(corner_luminances(column, row), 0.5f, 0.5f));
    }
  }
  levels_.push_back(std::move(cells));
  while (levels_.back().sums.size() > 1) {
    const Level& finer = levels_.back();
    Level coarser{(finer.width + 1) / 2, (finer.height + 1) / 2, {}};
    coarser.sums.reserve(static_cast<std::size_t>(coarser.width) * static_cast<std::size_t>(coarser.height));
    for (int y = 0; y < coarser.height; ++y) {
      for (int x = 0; x < coarser.width; ++x) {
        coarser.sums.push_back((finer.at(2 * x, 2 * y) + finer.at(2 * x + 1, 2 * y)) +
                               (finer.at(2 * x, 2 * y + 1) + finer.at(2 * x + 1, 2 * y + 1)));
      }
    }
    levels_.push_back(std::move(coarser));
  }
  total_ = levels_.back().sums.front();

  constexpr int kFineEnough = 64;
  std::size_t level = 0;
  while (levels_[level].width > kFineEnough) ++level;
  const int step = 1 << level;
  for (int y = 0; y < levels_[level].height; ++y) {
    for (int x = 0; x < levels_[level].width; ++x) {
      const int row = std::min(y * step + step / 2, height);
      const Place middle{std::min(x * step + step / 2, width - 1), row, 0.5f, 0.5f};
      float sine = 0.0f;
      add_to_faces(direction_of(middle, &sine), levels_[level].at(x, y));
    }
  }
}

const float* EnvironmentLight::texel(int column, int row) const {
  const int width = map_->pixels.width();
  return map_->pixels.at(column >= width ? column - width : column, std::clamp(row, 0, map_->pixels.height() - 1));
}

std::array<float, 4> EnvironmentLight::corner_luminances(int column, int row) const {
  const auto brightness = [&](int x, int y) { return map_->strength * luminance(Eigen::Map<const Vec3>(texel(x, y))); };
  return {brightness(column, row - 1), brightness(column + 1, row - 1), brightness(column, row),
          brightness(column + 1, row)};
}

EnvironmentLight::Place EnvironmentLight::place_of(const Vec3& direction) const {
  const int width = map_->pixels.width();
  const int height = map_->pixels.height();
  const float heading = std::atan2(direction.x(), -direction.z()) - map_->rotation_rad;
  float u = 0.5f + heading * (0.5f / kPi);
  u -= std::floor(u);
  const float sine = std::sqrt(direction.x() * direction.x() + direction.z() * direction.z());
  const float v = std::clamp(std::atan2(sine, direction.y()) / kPi, 0.0f, 1.0f);

  const float x = u * static_cast<float>(width) - 0.5f;
  const float left = std::floor(x);
  Place place;
  place.column = static_cast<int>(left);
  if (place.column < 0) place.column += width;
  if (place.column >= width) place.column = width - 1;
  place.x = x - left;
  place.row = std::min(static_cast<int>(std::floor(v * static_cast<float>(height) + 0.5f)), height);
  const float top = row_top(place.row, height);
  place.y = std::clamp((v - top) / (row_bottom(place.row, height) - top), 0.0f, 1.0f);
  return place;
}

Vec3 EnvironmentLight::direction_of(const Place& place, float* ret_sine) const {
  const int height = map_->pixels.height();
  const float u = (static_cast<float>(place.column) + 0.5f + place.x) / static_cast<float>(map_->pixels.width());
  const float top = row_top(place.row, height);
  const float v = top + place.y * (row_bottom(place.row, height) - top);
  const float heading = 2.0f * kPi * (u - 0.5f) + map_->rotation_rad;
  const float sine = std::sin(kPi * v);
  *ret_sine = sine;
  return {std::sin(heading) * sine, std::cos(kPi * v), -std::cos(heading) * sine};
}

Vec3 EnvironmentLight::map_radiance(const Place& place) const {
  const auto colour = [&](int x, int y) -> Vec3 { return Eigen::Map<const Vec3>(texel(x, y)); };
  const Vec3 top =
      (1.0f - place.x) * colour(place.column, place.row - 1) + place.x * colour(place.column + 1, place.row - 1);
  const Vec3 bottom =
      (1.0f - place.x) * colour(place.column, place.row) + place.x * colour(place.column + 1, place.row);
  return map_->strength * ((1.0f - place.y) * top + place.y * bottom);
}

float EnvironmentLight::map_pdf(const Place& place, float sine) const {
  const std::array<float, 4> corners = corner_luminances(place.column, place.row);
  const float mean = bilinear(corners, 0.5f, 0.5f);
  if (!(mean > 0.0f)) return 0.0f;
  const int height = map_->pixels.height();
  const float cell_uv =
      (row_bottom(place.row, height) - row_top(place.row, height)) / static_cast<float>(map_->pixels.width());
  const float chosen = levels_.front().at(place.column, place.row) / total_;
  const float inside = bilinear(corners, place.x, place.y) / mean;
  return chosen * inside / (cell_uv * 2.0f * kPi * kPi * std::max(sine, kMinSine));
}

Vec3 EnvironmentLight::radiance(const Vec3& direction) const {
  if (!shines_) return Vec3::Zero();
  return map_ != nullptr ? map_radiance(place_of(direction)) : sky_radiance(sky_, direction);
}

float EnvironmentLight::pdf(const Vec3& n, const Vec3& direction) const {
  if (!shines_) return 0.0f;
  if (map_ == nullptr && !n.isZero(0.0f)) return std::max(0.0f, n.dot(direction)) / kPi;
  if (map_ == nullptr) return luminance(sky_radiance(sky_, direction)) / total_;
  return map_pdf(place_of(direction), std::sqrt(direction.x() * direction.x() + direction.z() * direction.z()));
}

float EnvironmentLight::estimate(const Vec3& n) const {
  if (!shines_) return 0.0f;
  if (n.isZero(0.0f)) return total_;
  float sum = kMinCellShare * total_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float part = n[static_cast<Eigen::Index>(axis)];
    sum += part * part * faces_[2 * axis + (part < 0.0f ? 1 : 0)];
  }
  return sum;
}

bool EnvironmentLight::sample(const Vec3& n, const Vec2& u, LightSample* ret_sample) const {
  if (map_ != nullptr) return sample_map(u, ret_sample);
  return n.isZero(0.0f) ? sample_sky(u, ret_sample) : sample_sky_over(n, u, ret_sample);
}

bool EnvironmentLight::sample_sky_over(const Vec3& n, const Vec2& u, LightSample* ret_sample) const {
  const Vec3 direction = from_frame_of(n, cosine_hemisphere(u));
  const float pdf = n.dot(direction) / kPi;
  if (!(pdf > 0.0f)) return false;
  *ret_sample = {direction, kEndless, sky_radiance(sky_, direction) / pdf, pdf};
  return true;
}

bool EnvironmentLight::sample_sky(const Vec2& u, LightSample* ret_sample) const {
  float choice = u.x();
  const bool is_up = chooses_first(upper_, total_ - upper_, &choice);
  const float end = luminance(is_up ? sky_.zenith : sky_.ground);
  const float height = sample_linear(choice, luminance(sky_.horizon), end);
  const float sine = std::sqrt(std::max(0.0f, 1.0f - height * height));
  const float angle = 2.0f * kPi * u.y();
  const Vec3 direction(sine * std::cos(angle), is_up ? height : -height, sine * std::sin(angle));
  const Vec3 light = sky_radiance(sky_, direction);
  const float pdf = luminance(light) / total_;
  if (!(pdf > 0.0f)) return false;
  *ret_sample = {direction, kEndless, light / pdf, pdf};
  return true;
}

bool EnvironmentLight::sample_map(const Vec2& u, LightSample* ret_sample) const {
  float ux = u.x();
  float uy = u.y();
  int x = 0;
  int y = 0;
  for (std::size_t i = levels_.size() - 1; i-- > 0;) {
    const Level& level = levels_[i];
    x *= 2;
    y *= 2;
    const float left = level.at(x, y) + level.at(x, y + 1);
    const float right = level.at(x + 1, y) + level.at(x + 1, y + 1);
    if (!chooses_first(left, right, &ux)) ++x;
    if (!chooses_first(level.at(x, y), level.at(x, y + 1), &uy)) ++y;
  }
  const std::array<float, 4> corners = corner_luminances(x, y);
  Place place{x, y, 0.0f, 0.0f};
  place.y = sample_linear(uy, corners[0] + corners[1], corners[2] + corners[3]);
  place.x = sample_linear(ux, corners[0] + place.y * (corners[2] - corners[0]),
                          corners[1] + place.y * (corners[3] - corners[1]));
  float sine = 0.0f;
  const Vec3 direction = direction_of(place, &sine);
  const float pdf = map_pdf(place, sine);
  if (!(pdf > 0.0f)) return false;
  *ret_sample = {direction, kEndless, map_radiance(place) / pdf, pdf};
  return true;
}

}  // namespace cyclorama::render
