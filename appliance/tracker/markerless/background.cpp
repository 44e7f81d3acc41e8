// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/markerless/background.h"

#include <algorithm>
#include <cmath>

#include "appliance/tracker/markerless/light_fit.h"

namespace cyclorama::tracker {
namespace {

/// Grey levels that are added before the logarithm is taken; below this brightness a ratio has no meaning.
constexpr float kOffset = 8.0f;
constexpr float kMinDeviation = 0.015f;
constexpr float kFirstDeviation = 0.04f;
/// Differences from the room, in deviations, from which a cell begins to count as part of a person, and counts fully.
constexpr float kBegins = 3.0f;
constexpr float kIs = 6.0f;
/// Share of the cells outside of the visitor that the change of light must explain.
constexpr double kExplained = 0.55;
constexpr Duration kJump = std::chrono::seconds(5);
/// Noise of the logarithm above which a dark jacket cannot be distinguished from a wall.
constexpr double kTooNoisy = 0.12;
constexpr int kSampleEvery = 3;

float deviation_of(float variance) { return std::max(kMinDeviation, std::sqrt(variance)); }

}  // namespace

int Background::cell_px(int width_px) const {
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(width_px) / settings_.cells_across)));
}

void Background::begin(int width, int height, TimePoint at) {
  const Image<float, 1> empty(width, height);
  silhouette_ = {empty, empty, empty, LightState::kLearning};
  cells_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), {});
  grey_ = Image<float, 1>(width, height);
  level_ = Image<float, 1>(width, height);
  learning_since_ = at;
  noise_ = 0.0;
}

void Background::reduce(const GreyImage& picture) {
  const int side = cell_px(picture.width());
  const float per_pixel = 1.0f / static_cast<float>(side * side);
  std::vector<std::uint32_t> sums(static_cast<std::size_t>(grey_.width()));
  for (int y = 0; y < grey_.height(); ++y) {
    std::fill(sums.begin(), sums.end(), 0u);
    for (int v = y * side; v < (y + 1) * side; ++v) {
      const std::uint8_t* pixel = picture.at(0, v);
      for (std::uint32_t& sum : sums) {
        for (int i = 0; i < side; ++i) sum += *pixel++;
      }
    }
    for (int x = 0; x < grey_.width(); ++x)
      *grey_.at(x, y) = per_pixel * static_cast<float>(sums[static_cast<std::size_t>(x)]);
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) level_.data()[i] = std::log(grey_.data()[i] + kOffset);
}

bool Background::follow_light(const std::optional<CellBounds>& visitor) {
  const double across = 2.0 / level_.width();
  const double down = 2.0 / level_.height();
  std::vector<LogLightSample> samples;
  std::vector<float> deviations;
  for (int y = kSampleEvery / 2; y < level_.height(); y += kSampleEvery) {
    for (int x = kSampleEvery / 2; x < level_.width(); x += kSampleEvery) {
      const float grey = *grey_.at(x, y);
      if (grey < 2.0f || grey > 250.0f) continue;  // Clipped values give no ratio.
      const auto i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(level_.width()) + static_cast<std::size_t>(x);
      const double weight = visitor && visitor->contains(x, y) ? 0.0 : *silhouette_.share.at(x, y) > 0.5f ? 0.25 : 1.0;
      samples.push_back({across * x - 1.0, down * y - 1.0, double{level_.data()[i]} - double{cells_[i].mean}, weight});
      deviations.push_back(deviation_of(cells_[i].variance));
    }
  }
  const LightGain gain = fitted_light(samples);
  double explained = 0.0, all = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const LogLightSample& s = samples[i];
    if (s.weight <= 0.0) continue;
    all += s.weight;
    if (std::abs(s.log_ratio - gain.at(s.x, s.y)) < 3.5 * double{deviations[i]}) explained += s.weight;
  }
  for (int y = 0; y < level_.height(); ++y) {
    for (int x = 0; x < level_.width(); ++x)
      *level_.at(x, y) -= static_cast<float>(gain.at(across * x - 1.0, down * y - 1.0));
  }
  return all > 0.0 && explained >= kExplained * all;
}

void Background::learn_anew(const std::optional<CellBounds>& visitor) {
  std::size_t i = 0;
  for (int y = 0; y < level_.height(); ++y) {
    for (int x = 0; x < level_.width(); ++x, ++i) {
      // level_ excludes the best estimate of the light, so behind people the room as learned before is still valid.
      if ((visitor && visitor->contains(x, y)) || silhouette_.share.data()[i] > 0.5f) continue;
      cells_[i] = {level_.data()[i], kFirstDeviation * kFirstDeviation, 1.0f, level_.data()[i], 0.0f};
    }
  }
}

void Background::compare(double seconds, const std::optional<CellBounds>& visitor) {
  const auto dt = static_cast<float>(seconds);
  const auto slow = static_cast<float>(1.0 - std::exp(-seconds / to_seconds(settings_.follows_in)));
  const auto absorbs = static_cast<float>(to_seconds(settings_.absorbs_after));
  const bool learning = silhouette_.light == LightState::kLearning;
  std::size_t i = 0;
  for (int y = 0; y < level_.height(); ++y) {
    for (int x = 0; x < level_.width(); ++x, ++i) {
      Cell& cell = cells_[i];
      const float level = level_.data()[i];
      const float off = level - cell.mean;
      const float deviation = deviation_of(cell.variance);
      const float share =
          learning ? 0.0f : std::clamp((std::abs(off) / deviation - kBegins) / (kIs - kBegins), 0.0f, 1.0f);
      silhouette_.share.data()[i] = share;
      silhouette_.contrast.data()[i] = (grey_.data()[i] + kOffset) * std::abs(1.0f - std::exp(-off));
      const bool occupied = visitor && visitor->contains(x, y);
      if (share < 0.5f && !(occupied && share > 0.0f)) {
        cell.seen = std::min(cell.seen + 1.0f, 1e6f);
        const float weight = std::max(slow, 1.0f / cell.seen);
        cell.mean += weight * off;
        // Bounds the influence of a single outlier.
        cell.variance += weight * (std::min(off * off, 9.0f * deviation * deviation) - cell.variance);
        cell.still_s = 0.0f;
        continue;
      }
      if (occupied || std::abs(level - cell.held) > 3.0f * deviation) {
        cell.held = level;
        cell.still_s = 0.0f;
        continue;
      }
      cell.still_s += dt;
      if (cell.still_s > absorbs) cell = {level, kFirstDeviation * kFirstDeviation, 1.0f, level, 0.0f};
    }
  }
}

void Background::outline() {
  const auto width = static_cast<std::size_t>(level_.width());
  for (int y = 1; y + 1 < level_.height(); ++y) {
    for (int x = 1; x + 1 < level_.width(); ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      const float* const now = level_.data().data() + i;
      const float steep = std::abs(now[1] - now[-1]) + std::abs(now[width] - *(now - width));
      const float room =
          std::abs(cells_[i + 1].mean - cells_[i - 1].mean) + std::abs(cells_[i + width].mean - cells_[i - width].mean);
      silhouette_.outline.data()[i] = steep - room;
    }
  }
}

const Silhouette& Background::update(const GreyImage& picture, TimePoint at, const std::optional<CellBounds>& visitor) {
  const int side = cell_px(picture.width());
  const int width = picture.width() / side;
  const int height = picture.height() / side;
  const bool jumped = last_at_ && (at < *last_at_ - kJump || at > *last_at_ + kJump);
  const bool first = width != level_.width() || height != level_.height() || jumped;
  const double seconds = last_at_ && !first ? std::max(0.0, to_seconds(at - *last_at_)) : 0.0;
  if (first) begin(width, height, at);
  last_at_ = at;
  if (cells_.empty()) return silhouette_;

  std::vector<float> before(level_.data().begin(), level_.data().end());
  reduce(picture);
  if (first) learn_anew(std::nullopt);
  const bool explained = follow_light(visitor);
  // The noise is the change of a cell from one picture to the next while the light is known.
  if (!first && explained) {
    for (std::size_t i = 0; i < before.size(); ++i) before[i] = std::abs(before[i] - level_.data()[i]);
    const auto middle = before.begin() + static_cast<std::ptrdiff_t>(before.size() / 2);
    std::nth_element(before.begin(), middle, before.end());
    noise_ += 0.1 * (double{*middle} / 0.954 - noise_);
  }
  if (!explained) {
    learn_anew(visitor);
    std::fill(silhouette_.share.data().begin(), silhouette_.share.data().end(), 0.0f);
    silhouette_.light = LightState::kUnsettled;
    return silhouette_;
  }
  silhouette_.light = at - learning_since_ < settings_.learns_for ? LightState::kLearning : LightState::kSteady;
  compare(seconds, visitor);
  outline();
  if (noise_ > kTooNoisy) silhouette_.light = LightState::kDark;
  return silhouette_;
}

}  // namespace cyclorama::tracker
