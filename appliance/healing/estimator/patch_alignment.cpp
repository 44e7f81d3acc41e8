// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/patch_alignment.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace cyclorama::healing {
namespace {

constexpr double kCorrelation = 4.0;  // Factor on the variance: sampling and softening correlate neighbouring pixels.
constexpr double kPriorPx = 3.0;      // Prior sigma of the shift; decides where a patch has no gradient.
constexpr double kFloorPx = 0.02;     // Minimum sigma of a shift, due to sampling.
constexpr double kSettledPx = 0.003;

/// A patch of the prediction, prepared for the search.
struct Template {
  std::vector<float> values;  ///< Mean 0, length 1.
  std::vector<float> slope_x;
  std::vector<float> slope_y;
  Eigen::Matrix2d gradients = Eigen::Matrix2d::Zero();
  double contrast = 0.0;  ///< Standard deviation before normalisation.
};

float dot(const std::vector<float>& a, const std::vector<float>& b) {
  float sum = 0.0f;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Normalises to mean 0 and length 1; returns the former length.
float normalise(std::vector<float>* values) {
  float mean = 0.0f;
  for (const float v : *values) mean += v;
  mean /= static_cast<float>(values->size());
  float squares = 0.0f;
  for (float& v : *values) {
    v -= mean;
    squares += v * v;
  }
  const float length = std::sqrt(squares);
  const float scale = length > 1e-12f ? 1.0f / length : 0.0f;
  for (float& v : *values) v *= scale;
  return length;
}

void cut_template(const LightPlane& plane, int x, int y, int radius, Template* made) {
  made->values.clear();
  made->slope_x.clear();
  made->slope_y.clear();
  const int width = plane.width();
  for (int row = y - radius; row <= y + radius; ++row) {
    const float* p = plane.light.at(x - radius, row);
    for (int i = 0; i <= 2 * radius; ++i) {
      made->values.push_back(p[i]);
      made->slope_x.push_back(0.5f * (p[i + 1] - p[i - 1]));
      made->slope_y.push_back(0.5f * (p[i + width] - p[i - width]));
    }
  }
  const float length = normalise(&made->values);
  made->contrast = static_cast<double>(length) / std::sqrt(static_cast<double>(made->values.size()));
  for (std::vector<float>* slope : {&made->slope_x, &made->slope_y}) {
    float mean = 0.0f;
    for (const float v : *slope) mean += v;
    mean /= static_cast<float>(slope->size());
    for (float& v : *slope) v = length > 1e-12f ? (v - mean) / length : 0.0f;
    const float along = dot(*slope, made->values);
    for (std::size_t i = 0; i < slope->size(); ++i) (*slope)[i] -= along * made->values[i];
  }
  const auto xy = static_cast<double>(dot(made->slope_x, made->slope_y));
  made->gradients << static_cast<double>(dot(made->slope_x, made->slope_x)), xy, xy,
      static_cast<double>(dot(made->slope_y, made->slope_y));
}

/// Returns the projector that owns at least 90% of a patch; -1 if there is none, or if the patch extends beyond the
/// wall.
int owner_of(const Image<std::int8_t, 1>& owner, int x, int y, int radius) {
  std::array<int, 128> counts{};
  int own = 0;
  int all = 0;
  int best = -1;
  for (int row = y - radius; row <= y + radius; row += 2) {
    for (int column = x - radius; column <= x + radius; column += 2) {
      const std::int8_t who = *owner.at(column, row);
      ++all;
      if (who == kBesideWall) return -1;
      if (who < 0) continue;
      if (++counts[static_cast<std::size_t>(who)] > own) {
        own = counts[static_cast<std::size_t>(who)];
        best = who;
      }
    }
  }
  return 10 * own >= 9 * all ? best : -1;
}

bool sample(const LightPlane& plane, const Eigen::Vector2d& middle, int radius, std::vector<float>* values) {
  const double x = middle.x() - 0.5 - radius;
  const double y = middle.y() - 0.5 - radius;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const int side = 2 * radius + 1;
  if (x0 < 0 || y0 < 0 || x0 + side >= plane.width() || y0 + side >= plane.height()) return false;
  const auto fx = static_cast<float>(x - x0);
  const auto fy = static_cast<float>(y - y0);
  const float a = (1.0f - fx) * (1.0f - fy);
  const float b = fx * (1.0f - fy);
  const float c = (1.0f - fx) * fy;
  const float d = fx * fy;
  values->resize(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  float* to = values->data();
  for (int row = 0; row < side; ++row) {
    const float* upper = plane.light.at(x0, y0 + row);
    const float* lower = upper + plane.width();
    for (int i = 0; i < side; ++i) *to++ = a * upper[i] + b * upper[i + 1] + c * lower[i] + d * lower[i + 1];
  }
  return true;
}

/// Searches the picture for the template, from its predicted position. Returns false if the search leaves the picture.
bool look_for(const Template& wanted, const LightPlane& picture, int radius, const PatchOptions& options,
              std::vector<float>* values, PatchShift* patch) {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double remaining = 1.0;
  double length = 0.0;
  for (int round = 0; round < options.max_rounds; ++round) {
    if (!sample(picture, patch->at + shift, radius, values)) return false;
    length = static_cast<double>(normalise(values));
    double sum_x = 0.0;
    double sum_y = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < values->size(); ++i) {
      const float e = wanted.values[i] - (*values)[i];
      sum_x += static_cast<double>(wanted.slope_x[i] * e);
      sum_y += static_cast<double>(wanted.slope_y[i] * e);
      squares += static_cast<double>(e * e);
    }
    remaining = squares;
    const double noise = kCorrelation * std::max(squares, 1e-4) / static_cast<double>(values->size());
    const Eigen::Matrix2d normal = wanted.gradients + noise / (kPriorPx * kPriorPx) * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d step =
        normal.inverse() * (Eigen::Vector2d(sum_x, sum_y) - noise / (kPriorPx * kPriorPx) * shift);
    patch->covariance = noise * normal.inverse() + kFloorPx * kFloorPx * Eigen::Matrix2d::Identity();
    if (!step.allFinite() || step.norm() > options.max_shift_px + 2.0) break;
    shift += step;
    if (step.norm() < kSettledPx || shift.norm() > options.max_shift_px + 1.0) break;
  }
  patch->shift = shift;
  patch->likeness = 1.0 - 0.5 * remaining;
  patch->contrast = length / std::sqrt(static_cast<double>(values->size()));
  return true;
}

/// Returns whether the patch resembles another position of the prediction, at most `reach` pixels away in x and y.
bool repeats(const LightPlane& plane, const Template& wanted, int x, int y, int radius, int reach,
             std::vector<float>* values) {
  constexpr float kAlike = 0.85f;
  const double nearest = 0.5 * radius + 1.0;
  // Steps of half a pixel, since a period need not be whole.
  for (double dy = -reach; dy <= reach; dy += 0.5) {
    for (double dx = -reach; dx <= reach; dx += 0.5) {
      if (std::max(std::abs(dx), std::abs(dy)) < nearest) continue;
      if (!sample(plane, {x + dx + 0.5, y + dy + 0.5}, radius, values)) continue;
      normalise(values);
      if (dot(*values, wanted.values) > kAlike) return true;
    }
  }
  return false;
}

std::vector<PatchShift> align(const Prediction& prediction, const LightPlane& picture, double gain,
                              const PatchOptions& options, int repeat_radius) {
  std::vector<PatchShift> patches;
  const LightPlane& plane = prediction.light;
  const int radius = options.radius_px;
  const int margin = radius + 1;
  Template wanted;
  std::vector<float> values;
  for (int y = margin; y + margin < plane.height(); y += options.step_px) {
    for (int x = margin; x + margin < plane.width(); x += options.step_px) {
      PatchShift patch;
      patch.at = {x + 0.5, y + 0.5};
      patch.projector = owner_of(prediction.owner, x, y, radius);
      if (patch.projector < 0) {
        patches.push_back(patch);
        continue;
      }
      cut_template(plane, x, y, radius, &wanted);
      const double expected = gain * wanted.contrast;
      if (!(expected > options.min_contrast)) {
        patch.fit = PatchFit::kPlain;
        patches.push_back(patch);
        continue;
      }
      if (repeat_radius > 0 && repeats(plane, wanted, x, y, radius, repeat_radius, &values)) {
        patches.push_back(patch);
        continue;
      }
      if (!look_for(wanted, picture, radius, options, &values, &patch)) {
        patches.push_back(patch);
        continue;
      }
      patch.contrast /= expected;
      const bool is_there = patch.likeness >= options.min_likeness && patch.shift.norm() <= options.max_shift_px;
      patch.fit = is_there ? PatchFit::kFits : PatchFit::kDiffers;
      patches.push_back(patch);
    }
  }
  return patches;
}

}  // namespace

LightScale light_scale(const Prediction& prediction, const LightPlane& picture) {
  constexpr int kBlock = 16;
  std::vector<Eigen::Vector2d> means;
  for (int y = 0; y + kBlock <= picture.height(); y += kBlock) {
    for (int x = 0; x + kBlock <= picture.width(); x += kBlock) {
      Eigen::Vector2d sum(0.0, 0.0);
      bool is_wall = true;
      for (int row = y; row < y + kBlock && is_wall; row += 2) {
        for (int column = x; column < x + kBlock; column += 2) {
          is_wall = is_wall && *prediction.owner.at(column, row) != kBesideWall;
          sum += Eigen::Vector2d(static_cast<double>(*prediction.light.light.at(column, row)),
                                 static_cast<double>(*picture.light.at(column, row)));
        }
      }
      if (is_wall) means.push_back(sum * 4.0 / (kBlock * kBlock));
    }
  }
  if (means.size() < 8) return {};
  // The line goes through the medians of the darker and of the brighter half, so that neither a person nor a lamp that
  // is off inverts its slope.
  std::ranges::sort(means, [](const auto& a, const auto& b) { return a.x() < b.x(); });
  const auto half = static_cast<std::ptrdiff_t>(means.size() / 2);
  const auto median = [](auto begin, auto end, int axis) {
    std::vector<double> values;
    for (auto it = begin; it != end; ++it) values.push_back((*it)[axis]);
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
  };
  const double dark = median(means.begin(), means.begin() + half, 0);
  const double bright = median(means.begin() + half, means.end(), 0);
  const double seen_dark = median(means.begin(), means.begin() + half, 1);
  const double seen_bright = median(means.begin() + half, means.end(), 1);
  if (!(bright - dark > 1e-9)) return {};
  const double gain = std::max(0.0, (seen_bright - seen_dark) / (bright - dark));
  return {gain, seen_dark - gain * dark};
}

std::vector<PatchShift> align_patches(const Prediction& prediction, const LightPlane& picture, double gain,
                                      const PatchOptions& options) {
  return align(prediction, picture, gain, options, 0);
}

std::vector<PatchShift> align_coarsely(const Prediction& prediction, const LightPlane& picture, double gain) {
  constexpr int kFactor = 4;
  constexpr int kRepeatRadius = 6;
  Prediction small{halved(halved(prediction.light)), {}};
  small.owner = Image<std::int8_t, 1>(small.light.width(), small.light.height());
  for (int y = 0; y < small.light.height(); ++y) {
    for (int x = 0; x < small.light.width(); ++x)
      *small.owner.at(x, y) = *prediction.owner.at(kFactor * x + kFactor / 2, kFactor * y + kFactor / 2);
  }
  PatchOptions options;
  options.radius_px = 7;
  options.step_px = 5;
  options.max_rounds = 15;
  options.max_shift_px = 4.0;
  options.min_likeness = 0.7;
  std::vector<PatchShift> patches = align(small, halved(halved(picture)), gain, options, kRepeatRadius);
  for (PatchShift& patch : patches) {
    patch.at *= kFactor;
    patch.shift *= kFactor;
    patch.covariance *= kFactor * kFactor;
  }
  return patches;
}

}  // namespace cyclorama::healing
