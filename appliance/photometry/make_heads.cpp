// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/make_heads.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "appliance/photometry/slow_target.h"

namespace cyclorama::photometry {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTargetStep_rad = 0.35 * kDegree;
constexpr double kBlur_rad = 1.0 * kDegree;
// Half width of the zone around a border: two standard deviations of the blur.
constexpr double kBeside_rad = 2.0 * kDegree;
constexpr double kNoShare = 1e-3;  // A projector with a smaller share does not limit a point's light.
constexpr int kStep_px = 2;        // Masks are smooth, so every other pixel suffices.
constexpr float kSteep = 0.03f;    // Maximum change of a weight over an interpolated step.
// Maximum bend of a weight over an interpolated step; the interpolation's error is an eighth of the bend.
constexpr float kBent = 0.004f;
constexpr double kMinBlackLift = 1e-7;

/// Values of one head pixel.
struct PixelShare {
  bool is_lit = false;
  float mask = 0.0f;
  float weight = 0.0f;
  float black_lift = 0.0f;  ///< Relative to the head's white at that pixel; not scaled yet.
};

/// Values of every kStep_px-th pixel each way.
struct CoarseShares {
  int columns = 0;
  int rows = 0;
  std::vector<PixelShare> all;

  [[nodiscard]] const PixelShare& at(int column, int row) const {
    return all[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
  /// Returns the largest change of slope of the weight; 0 at the rim, 1 beside unlit pixels.
  [[nodiscard]] float bend(int column, int row) const {
    float max = 0.0f;
    for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1)}) {
      if (column < dx || row < dy || column + dx >= columns || row + dy >= rows) continue;
      const PixelShare& before = at(column - dx, row - dy);
      const PixelShare& behind = at(column + dx, row + dy);
      if (!before.is_lit || !behind.is_lit) return 1.0f;
      max = std::max(max, std::abs(before.weight - 2.0f * at(column, row).weight + behind.weight));
    }
    return max;
  }
  /// Returns true if the pixels between this one and its coarse neighbours to the right and below can be interpolated.
  [[nodiscard]] bool is_even(int column, int row) const {
    float min = 1.0f;
    float max = 0.0f;
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)}) {
      const PixelShare& corner = at(column + dx, row + dy);
      if (!corner.is_lit || bend(column + dx, row + dy) > kBent) return false;
      min = std::min(min, corner.weight);
      max = std::max(max, corner.weight);
    }
    return max - min < kSteep;
  }
};

class HeadMaker {
 public:
  HeadMaker(const PhotometryInput& input, const WallLighting& lighting, const BlendWeights& weights,
            std::vector<double> kept)
      : input_(input), lighting_(lighting), weights_(weights), kept_(std::move(kept)) {}

  Status find_targets(const PhotometryOptions& options);
  void report_light_kept(Photometry* result) const;
  void make_images(std::size_t projector, PhotometricHead* head) const;
  /// Returns the colour of luminance 1, in `projector`'s channels, that replaces missing black levels of the others.
  [[nodiscard]] Eigen::Vector3d black_lift_colour(std::size_t projector) const;

 private:
  using Shares = std::vector<BlendWeights::Share>;
  [[nodiscard]] double white_of(const BlendWeights::Share& share) const {
    return lighting_.projectors[share.projector].white_at(share.pixel);
  }
  /// Returns the peak luminance that blending can give in a direction; infinite where no projector lights.
  [[nodiscard]] double peak(const Shares& shares) const {
    double min = std::numeric_limits<double>::infinity();
    for (const auto& share : shares) {
      if (share.weight > kNoShare) min = std::min(min, kept_[share.projector] * white_of(share) / share.weight);
    }
    return min;
  }
  [[nodiscard]] double black(const Eigen::Vector3d& direction, const Shares& shares) const {
    Eigen::Vector3d colour = lighting_.ambient_at(direction);
    for (const auto& share : shares) colour += white_of(share) * lighting_.projectors[share.projector].black_level;
    return kCameraLuminance.dot(colour);
  }
  [[nodiscard]] std::vector<double> slopes(const PhotometryOptions& options) const;
  [[nodiscard]] PixelShare share_of(std::size_t projector, const Eigen::Vector2d& pixel) const;

  const PhotometryInput& input_;
  const WallLighting& lighting_;
  const BlendWeights& weights_;
  std::vector<double> kept_;
  std::optional<DirectionField> peak_;
  std::optional<DirectionField> target_;
  std::optional<DirectionField> inverse_black_;  ///< Inverse of the target black level.
};

/// Returns the maximum slope of the brightness per grid point of the target fields.
std::vector<double> HeadMaker::slopes(const PhotometryOptions& options) const {
  const auto pictures = [this](const Eigen::Vector3d& direction) {
    unsigned which = 0;
    for (const auto& share : weights_.at(direction)) which |= 1u << (share.projector % 32);
    return which;
  };
  const std::vector<bool> is_near = peak_->near_borders(pictures, kBeside_rad);
  const double everywhere = options.max_slope_per_deg / kDegree;
  const double at_borders = std::min(options.max_slope_at_borders_per_deg, options.max_slope_per_deg) / kDegree;
  std::vector<double> result;
  for (const bool near : is_near) result.push_back(near ? at_borders : everywhere);
  return result;
}

Status HeadMaker::find_targets(const PhotometryOptions& options) {
  TRY_ASSIGN(peak_, DirectionField::over(input_.projectors, kTargetStep_rad));
  DirectionField dark = *peak_;
  peak_->fill([this](const Eigen::Vector3d& d) { return peak(weights_.at(d)); });
  const auto reached = peak_->positions();
  if (std::ranges::none_of(reached, [](const auto& position) { return std::isfinite(position.value); }))
    return Error(ErrorCode::kBadData, "no direction gets light; measure the maps again");
  const std::vector<double> slope = slopes(options);
  target_ = peak_->slow_below(slope, kBlur_rad);
  if (!options.lifts_black) return Done{};
  bool is_any_black = false;
  dark.fill([&](const Eigen::Vector3d& d) {
    const auto shares = weights_.at(d);
    const double light = shares.empty() ? 0.0 : black(d, shares);
    is_any_black |= light > 0.0;
    return light > 0.0 ? 1.0 / light : std::numeric_limits<double>::infinity();
  });
  if (is_any_black) inverse_black_ = dark.slow_below(slope, kBlur_rad);
  return Done{};
}

void HeadMaker::report_light_kept(Photometry* result) const {
  DirectionField all = *peak_;
  all.fill([this](const Eigen::Vector3d& d) {
    double sum = 0.0;
    for (const auto& share : weights_.at(d)) sum += white_of(share);
    return sum;
  });
  const auto reached = peak_->positions();
  const auto wanted = target_->positions();
  const auto whole = all.positions();
  double could = 0.0;
  double kept = 0.0;
  double area = 0.0;
  double darkest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (!std::isfinite(reached[i].value)) continue;
    could += whole[i].area_sr * whole[i].value;
    kept += wanted[i].area_sr * wanted[i].value;
    area += reached[i].area_sr;
    darkest = std::min(darkest, reached[i].value);
  }
  result->light_kept = kept / could;
  result->light_kept_flat = darkest * area / could;
}

PixelShare HeadMaker::share_of(std::size_t projector, const Eigen::Vector2d& pixel) const {
  const auto direction = input_.projectors[projector].map.direction_at(pixel);
  if (!direction) return {};
  const Shares shares = weights_.at(*direction, projector, pixel);
  PixelShare result;
  result.is_lit = true;
  for (const auto& share : shares) {
    if (share.projector != projector) continue;
    const double white = white_of(share);
    const double mask = share.weight * target_->at(*direction) / (kept_[projector] * white);
    result.weight = static_cast<float>(share.weight);
    result.mask = static_cast<float>(std::clamp(mask, 0.0, 1.0));
    if (!inverse_black_) continue;
    const double missing = 1.0 / inverse_black_->at(*direction) - black(*direction, shares);
    result.black_lift = static_cast<float>(share.weight * std::max(0.0, missing) / white);
  }
  return result;
}

Eigen::Vector3d HeadMaker::black_lift_colour(std::size_t projector) const {
  Eigen::Vector3d missing = Eigen::Vector3d::Zero();
  for (std::size_t p = 0; p < lighting_.projectors.size(); ++p) {
    if (p != projector) missing += lighting_.projectors[p].black_level;
  }
  const ProjectorLighting& own = lighting_.projectors[projector];
  const Eigen::Vector3d neutral = Eigen::Vector3d::Ones();  // The luminance of white is 1.
  if (!(kCameraLuminance.dot(missing) > 0.0)) return neutral;
  const Eigen::Vector3d channels = (own.primaries.inverse() * missing).cwiseMax(0.0);
  const double luminance = kCameraLuminance.dot(own.primaries * channels);
  return luminance > 0.0 ? Eigen::Vector3d(channels / luminance) : neutral;
}

void HeadMaker::make_images(std::size_t projector, PhotometricHead* head) const {
  const calibration::MeasuredMap& map = input_.projectors[projector].map;
  CoarseShares coarse{map.width_px / kStep_px + 2, map.height_px / kStep_px + 2, {}};
  for (int y = 0; y < coarse.rows; ++y) {
    for (int x = 0; x < coarse.columns; ++x) {
      const Eigen::Vector2d pixel(std::min(x * kStep_px, map.width_px), std::min(y * kStep_px, map.height_px));
      coarse.all.push_back(share_of(projector, pixel));
    }
  }
  head->mask = warp::MaskImage(map.width_px, map.height_px);
  head->weight = warp::MaskImage(map.width_px, map.height_px);
  warp::BlackLiftImage black_lift(map.width_px, map.height_px);
  float brightest = 0.0f;
  for (int y = 0; y < map.height_px; ++y) {
    const int row = y / kStep_px;
    const float fy = (static_cast<float>(y - row * kStep_px) + 0.5f) / kStep_px;
    for (int x = 0; x < map.width_px; ++x) {
      const int column = x / kStep_px;
      const float fx = (static_cast<float>(x - column * kStep_px) + 0.5f) / kStep_px;
      const std::array<const PixelShare*, 4> corners = {&coarse.at(column, row), &coarse.at(column + 1, row),
                                                        &coarse.at(column, row + 1), &coarse.at(column + 1, row + 1)};
      const std::array<float, 4> parts = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
      PixelShare share;
      const bool is_inside = (column + 1) * kStep_px <= map.width_px && (row + 1) * kStep_px <= map.height_px;
      if (is_inside && coarse.is_even(column, row)) {
        for (std::size_t i = 0; i < 4; ++i) {
          share.mask += parts.at(i) * corners.at(i)->mask;
          share.weight += parts.at(i) * corners.at(i)->weight;
          share.black_lift += parts.at(i) * corners.at(i)->black_lift;
        }
      } else {
        share = share_of(projector, Eigen::Vector2d(x + 0.5, y + 0.5));
      }
      *head->mask.at(x, y) = share.mask;
      *head->weight.at(x, y) = share.weight;
      *black_lift.at(x, y) = share.black_lift;
      brightest = std::max(brightest, share.black_lift);
    }
  }
  if (!(static_cast<double>(brightest) > kMinBlackLift)) return;
  for (float& value : black_lift.data()) value = std::min(1.0f, value / brightest);
  head->colour.black = static_cast<double>(brightest) * black_lift_colour(projector);
  head->colour.black_lift = std::move(black_lift);
}

}  // namespace

Status make_heads(const PhotometryInput& input, const PhotometryOptions& options, const WallLighting& lighting,
                  const BlendWeights& weights, const CommonGamut* gamut, Photometry* result) {
  std::vector<double> kept(input.projectors.size(), 1.0);
  if (gamut != nullptr) kept = gamut->kept;
  HeadMaker maker(input, lighting, weights, kept);
  TRY(maker.find_targets(options));
  maker.report_light_kept(result);
  double brightest = 0.0;
  for (std::size_t p = 0; p < input.projectors.size(); ++p) {
    PhotometricHead& head = result->heads[p];
    const calibration::MeasuredMap& map = input.projectors[p].map;
    maker.make_images(p, &head);
    if (gamut != nullptr) head.colour.matrix = gamut->matrices[p];
    head.primaries = lighting.projectors[p].primaries;
    head.black = lighting.projectors[p].black_level;
    head.brightness = kept[p] * lighting.projectors[p].white_at({0.5 * map.width_px, 0.5 * map.height_px});
    brightest = std::max(brightest, head.brightness);
  }
  for (PhotometricHead& head : result->heads) head.brightness /= brightest;
  if (gamut != nullptr) result->wall = gamut->wall;
  return Done{};
}

}  // namespace cyclorama::photometry
