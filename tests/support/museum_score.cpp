// SPDX-License-Identifier: Apache-2.0
#include "tests/support/museum_score.h"

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

namespace cyclorama {
namespace {

using Slope = Eigen::Matrix<double, 3, 2>;

double in_pixels(const Slope& slope, const Eigen::Vector3d& error) {
  return (slope.transpose() * slope).ldlt().solve(slope.transpose() * error).norm();
}

double at_fraction(std::vector<double>* values, double fraction) {
  if (values->empty()) return 0.0;
  std::sort(values->begin(), values->end());
  return (
      *values)[std::min(values->size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(values->size())))];
}

}  // namespace

MuseumScore museum_score(const simulated::TrueMuseum& truth, const DirectionOfPixel& mapped,
                         const SigmaOfPixel& stated) {
  // The length of a deviation with unit variance in each of two axes is shorter than this in 95 of 100 cases.
  constexpr double kWithin95 = 2.4477;
  struct Place {
    Eigen::Vector3d true_direction;
    Eigen::Vector3d found;
    Slope slope;
    double sigma_px = 0.0;
  };
  const Point<frame::Room> eye = truth.turning_point();
  const auto slope_at = [&](std::size_t p, const Eigen::Vector2d& pixel) -> std::optional<Slope> {
    Slope slope;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d half = 0.5 * Eigen::Vector2d::Unit(axis);
      const auto a = truth.direction_at(p, pixel.x() - half.x(), pixel.y() - half.y(), eye);
      const auto b = truth.direction_at(p, pixel.x() + half.x(), pixel.y() + half.y(), eye);
      if (!a || !b) return std::nullopt;
      slope.col(axis) = *b - *a;
    }
    return slope;
  };
  MuseumScore score;
  std::vector<Place> correspondences;
  std::vector<double> apart;
  Eigen::Matrix3d together = Eigen::Matrix3d::Zero();
  const auto& projectors = truth.truth().projectors;
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    const Pinhole& lens = projectors[p].lens.pinhole();
    const int step = std::max(4, lens.width_px / 80);
    for (int y = step / 2; y < lens.height_px; y += step) {
      for (int x = step / 2; x < lens.width_px; x += step) {
        const Eigen::Vector2d pixel(x + 0.37, y + 0.61);
        const auto at = truth.wall_at(p, pixel.x(), pixel.y());
        const auto slope = slope_at(p, pixel);
        const auto direction = truth.direction_at(p, pixel.x(), pixel.y(), eye);
        if (!at || !slope || !direction) continue;
        ++score.lit;
        const auto found = mapped(p, pixel);
        if (!found || !found->allFinite()) {
          ++score.missing;
          continue;
        }
        correspondences.push_back({*direction, *found, *slope, stated ? stated(p, pixel) : 0.0});
        together += *found * direction->transpose();
        for (std::size_t other = p + 1; other < projectors.size(); ++other) {
          const auto lights = truth.projector_pixel(other, *at);
          if (!lights || !projectors[other].lens.pinhole().contains(*lights)) continue;
          const auto found_there = mapped(other, *lights);
          const auto slope_there = slope_at(other, *lights);
          if (!found_there || !found_there->allFinite() || !slope_there) continue;
          // Both maps have the same rotation relative to the truth; it is too small to matter here.
          apart.push_back(in_pixels(*slope_there, *found - *found_there));
        }
      }
    }
  }
  score.correspondences = apart.size();
  for (const double error : apart) score.mean_px += error / static_cast<double>(apart.size());
  score.p95_px = at_fraction(&apart, 0.95);
  score.max_px = apart.empty() ? 0.0 : apart.back();
  score.apart_px = std::move(apart);
  if (correspondences.empty()) return score;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(together, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d turn = svd.matrixV() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixU().transpose();
  std::vector<double> off;
  std::size_t covered = 0;
  for (const Place& position : correspondences) {
    off.push_back(in_pixels(position.slope, turn * position.found - position.true_direction));
    if (off.back() <= kWithin95 * position.sigma_px) ++covered;
  }
  score.covered_95 = static_cast<double>(covered) / static_cast<double>(off.size());
  score.true_p95_px = at_fraction(&off, 0.95);
  score.true_max_px = off.back();
  return score;
}

}  // namespace cyclorama
