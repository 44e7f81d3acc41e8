// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/wall_light.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "appliance/photometry/cell_light.h"

namespace cyclorama::photometry {
namespace {

constexpr int kKnot_px = 32;
constexpr double kBend = 0.01;      // Expected change of slope of log(light) from knot to knot.
constexpr double kMinSigma = 2e-3;  // Lower bound of the relative sigma: a wall's paint, and speckle.
constexpr std::size_t kMinGroups = 12;
constexpr double kVignetting = 0.7;  // Prior sigma of each vignetting coefficient.
constexpr double kMinTrust = 1e-3;
constexpr int kRounds = 3;  // Rounds of robust weights against disturbed cells.
constexpr double kGross = 0.01;
constexpr double kBlackLevelPrior = 1e-3;  // Prior sigma of the black level: the contrast is about 1000 to 1 or more.

/// One cell of one view, with the luminance of white.
struct Sample {
  const ProjectorView* view = nullptr;
  CellLight light;
  double log_white = 0.0;
  Eigen::Vector3d by_radius = Eigen::Vector3d::Zero();  ///< r^2, r^4, r^6; see WallLighting::vignetting.
  double trust = 1.0;                                   ///< Weight relative to other views of the same cell.
  double weight = 1.0;

  [[nodiscard]] Eigen::Vector2d pixel() const { return view->cells.cells[light.cell].projector_px; }
};

Eigen::Vector3d radius_terms(const PhotometryInput& input, const Eigen::Vector2d& camera_px) {
  const Eigen::Vector2d middle(0.5 * input.camera_width_px, 0.5 * input.camera_height_px);
  const double square = (camera_px - input.camera_centre_px.value_or(middle)).squaredNorm() / middle.squaredNorm();
  return {square, square * square, square * square * square};
}

/// Returns the weight of a position in the camera's picture relative to other views of the same cell. It decreases
/// towards the picture's sides, so that a view's error causes no step where the view ends.
double trust(const PhotometryInput& input, const Eigen::Vector2d& camera_px) {
  const double from_side = std::min(
      {camera_px.x(), camera_px.y(), input.camera_width_px - camera_px.x(), input.camera_height_px - camera_px.y()});
  const double t = std::clamp(2.0 * from_side / std::min(input.camera_width_px, input.camera_height_px), 0.0, 1.0);
  return std::max(kMinTrust, t * t);
}

/// Returns the median primaries of the cells, scaled so that white has luminance 1. Writes the variation between cells
/// to `spread`.
std::optional<Eigen::Matrix3d> common_primaries(const std::vector<Sample>& samples, double* spread) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  std::vector<Eigen::Matrix3d> all;
  for (const Sample& sample : samples) {
    if (!sample.light.has_primaries) continue;
    const double luminance = kCameraLuminance.dot(sample.light.primaries.rowwise().sum());
    if (luminance > 0.0) all.emplace_back(sample.light.primaries / luminance);
  }
  if (all.empty()) return std::nullopt;
  // The median of each entry is robust against somebody who walks past some cells.
  for (Eigen::Index i = 0; i < 9; ++i) {
    std::vector<double> values;
    for (const Eigen::Matrix3d& m : all) values.push_back(m(i % 3, i / 3));
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    sum(i % 3, i / 3) = *middle;
  }
  sum /= kCameraLuminance.dot(sum.rowwise().sum());
  std::vector<double> differences;
  for (const Eigen::Matrix3d& m : all) differences.push_back((m - sum).norm() / sum.norm());
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  *spread = *middle;
  return sum;
}

double white_boost(const std::vector<Sample>& samples, const std::array<ChannelResponse, 3>& curves) {
  std::vector<double> ratios;
  for (const Sample& sample : samples) {
    if (!sample.light.has_primaries || !sample.light.has_white) continue;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c)
      sum += curves.at(static_cast<std::size_t>(c)).light_of(1.0) * sample.light.primaries.col(c);
    const double ratio = kCameraLuminance.dot(sample.light.white) / kCameraLuminance.dot(sum);
    if (std::isfinite(ratio) && ratio > 0.0) ratios.push_back(ratio);
  }
  if (ratios.empty()) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

/// Returns the luminance of red, green and blue together at full code, also where only white was shown.
double luminance_of(const CellLight& light, const Eigen::Matrix3d& primaries,
                    const std::array<ChannelResponse, 3>& curves, double boost) {
  if (light.has_white) {
    // White shows each channel at level 1, which is not its maximum if its response decreases.
    Eigen::Vector3d full = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) full += curves.at(static_cast<std::size_t>(c)).light_of(1.0) * primaries.col(c);
    return kCameraLuminance.dot(light.white) / (boost * kCameraLuminance.dot(full));
  }
  return kCameraLuminance.dot(light.primaries.rowwise().sum());
}

double sigma_of(const Sample& sample) { return std::hypot(sample.light.sigma, kMinSigma); }

/// Returns the Cauchy weight of a residual of log(light).
double weight_of(double residual, const Sample& sample) {
  const double ratio = residual / std::max(kGross, 4.0 * sample.light.sigma);
  return 1.0 / (1.0 + ratio * ratio);
}

/// Solves for the camera's vignetting from cells that two or more stops saw, since such a cell has the same light for
/// all of them. Nothing else separates the camera's vignetting from that of the projectors.
bool solve_vignetting(std::vector<std::vector<Sample>>* samples, WallLighting* result) {
  std::vector<std::vector<Sample*>> groups;
  for (std::vector<Sample>& of_projector : *samples) {
    std::map<std::size_t, std::vector<Sample*>> cells;
    for (Sample& sample : of_projector) cells[sample.light.cell].push_back(&sample);
    for (auto& [cell, group] : cells) {
      if (group.size() > 1) groups.push_back(std::move(group));
    }
  }
  result->has_vignetting = groups.size() >= kMinGroups;
  if (!result->has_vignetting) return true;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() / (kVignetting * kVignetting);
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const auto& group : groups) {
      Eigen::Vector4d mean = Eigen::Vector4d::Zero();
      double sum = 0.0;
      for (const Sample* sample : group) {
        const double weight = sample->weight / (sigma_of(*sample) * sigma_of(*sample));
        mean += weight *
                Eigen::Vector4d(sample->by_radius.x(), sample->by_radius.y(), sample->by_radius.z(), sample->log_white);
        sum += weight;
      }
      mean /= sum;
      for (Sample* sample : group) {
        const Eigen::Vector3d terms = sample->by_radius - mean.head<3>();
        const double light = sample->log_white - mean.w();
        if (round > 0) sample->weight = weight_of(light - terms.dot(result->vignetting), *sample);
        const double weight = sample->weight / (sigma_of(*sample) * sigma_of(*sample));
        normal += weight * terms * terms.transpose();
        right += weight * light * terms;
      }
    }
    result->vignetting = normal.ldlt().solve(right);
    if (!result->vignetting.allFinite()) return false;
  }
  return true;
}

/// Fits a smooth field to each projector's light, and computes the residual of the readings.
bool solve_fields(const PhotometryInput& input, std::vector<std::vector<Sample>>* all, WallLighting* result) {
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t p = 0; p < all->size(); ++p) {
    std::vector<Sample>& samples = (*all)[p];
    const calibration::MeasuredMap& map = input.projectors[p].map;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<FieldSample> positions;
      Eigen::VectorXd values(static_cast<Eigen::Index>(samples.size()));
      for (std::size_t i = 0; i < samples.size(); ++i) {
        positions.push_back(
            {samples[i].pixel(), sigma_of(samples[i]) / std::sqrt(samples[i].weight * samples[i].trust)});
        values(static_cast<Eigen::Index>(i)) = samples[i].log_white - samples[i].by_radius.dot(result->vignetting);
      }
      const FieldFit fit(map.width_px, map.height_px, kKnot_px, kBend, positions);
      if (!fit.is_solved()) return false;
      PictureField& field = result->projectors[p].log_white;
      field = fit.fit(values);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const double residual = values(static_cast<Eigen::Index>(i)) - field.at(samples[i].pixel());
        samples[i].weight = weight_of(residual, samples[i]);
        if (round + 1 < kRounds) continue;
        squares += samples[i].weight * residual * residual;
        count += samples[i].weight;
      }
    }
  }
  result->unexplained = std::sqrt(squares / std::max(count, 1.0));
  return std::isfinite(result->unexplained);
}

/// Fits the light while all projectors show black: the ambient light plus the black levels of the projectors.
void fit_black(const PhotometryInput& input, const std::vector<std::vector<Sample>>& samples,
               const std::vector<InverseMap>& inverses, WallLighting* result) {
  const auto projectors = static_cast<Eigen::Index>(input.projectors.size());
  const Eigen::Index unknowns = 4 + projectors;
  std::array<Eigen::MatrixXd, 3> normal;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns, 3);
  normal.fill(Eigen::MatrixXd::Zero(unknowns, unknowns));
  double brightest = 0.0;
  for (const ProjectorLighting& lighting : result->projectors)
    brightest = std::max(brightest, std::exp(lighting.log_white.max));
  for (std::size_t p = 0; p < samples.size(); ++p) {
    for (const Sample& sample : samples[p]) {
      const auto direction = input.projectors[p].map.direction_at(sample.pixel());
      if (!direction) continue;
      Eigen::VectorXd row = Eigen::VectorXd::Zero(unknowns);
      row.head<3>() = *direction;
      row(3) = 1.0;
      for (Eigen::Index j = 0; j < projectors; ++j) {
        const auto at = static_cast<std::size_t>(j);
        const auto pixel = at == p ? std::optional(sample.pixel()) : inverses[at].pixel_at(*direction);
        if (pixel) row(4 + j) = result->projectors[at].white_at(*pixel);
      }
      const double seen_through = std::exp(sample.by_radius.dot(result->vignetting));
      for (int k = 0; k < 3; ++k) {
        const double sigma = std::max(sample.light.black_sigma(k) / seen_through, 1e-6 * brightest);
        const double weight = 1.0 / (sigma * sigma);
        normal.at(static_cast<std::size_t>(k)) += weight * row * row.transpose();
        right.col(k) += weight * sample.light.black(k) / seen_through * row;
      }
    }
  }
  for (int k = 0; k < 3; ++k) {
    Eigen::MatrixXd& matrix = normal.at(static_cast<std::size_t>(k));
    for (int i = 0; i < 3; ++i) matrix(i, i) += 1.0 / std::pow(1e-3 * brightest, 2);
    matrix(3, 3) += 1.0 / std::pow(0.1 * brightest, 2);
    for (Eigen::Index j = 0; j < projectors; ++j) matrix(4 + j, 4 + j) += 1.0 / (kBlackLevelPrior * kBlackLevelPrior);
    const Eigen::VectorXd solved = matrix.ldlt().solve(right.col(k));
    if (!solved.allFinite()) continue;
    result->ambient.row(k) = solved.head<4>().transpose();
    for (Eigen::Index j = 0; j < projectors; ++j)
      result->projectors[static_cast<std::size_t>(j)].black_level(k) = std::max(0.0, solved(4 + j));
  }
}

}  // namespace

double ProjectorLighting::white_at(const Eigen::Vector2d& pixel) const { return std::exp(log_white.at(pixel)); }

Eigen::Vector3d WallLighting::ambient_at(const Eigen::Vector3d& direction) const {
  return (ambient * direction.homogeneous()).cwiseMax(0.0);
}

Result<WallLighting> wall_lighting(const PhotometryInput& input, const SolvedResponses& responses,
                                   const std::vector<std::array<ChannelResponse, 3>>& curves,
                                   const std::vector<InverseMap>& inverses) {
  WallLighting result;
  result.projectors.resize(input.projectors.size());
  std::vector<std::vector<Sample>> samples(input.projectors.size());
  for (const ProjectorView& view : input.views) {
    for (const CellLight& light : cell_lights(input, view, responses.camera, curves[view.projector])) {
      Sample sample{&view, light};
      sample.by_radius = radius_terms(input, view.cells.cells[light.cell].camera_px);
      sample.trust = trust(input, view.cells.cells[light.cell].camera_px);
      samples[view.projector].push_back(sample);
    }
  }
  for (std::size_t p = 0; p < samples.size(); ++p) {
    std::map<std::size_t, double> best;
    for (const Sample& sample : samples[p]) best[sample.light.cell] = std::max(best[sample.light.cell], sample.trust);
    for (Sample& sample : samples[p]) sample.trust /= best[sample.light.cell];
    ProjectorLighting& lighting = result.projectors[p];
    const auto primaries = common_primaries(samples[p], &lighting.colour_spread);
    if (primaries) lighting.primaries = *primaries;
    lighting.white_boost = white_boost(samples[p], curves[p]);
    for (Sample& sample : samples[p]) {
      const double white = luminance_of(sample.light, lighting.primaries, curves[p], lighting.white_boost);
      sample.log_white = std::log(white);
    }
    // Cells without light are removed.
    std::erase_if(samples[p], [](const Sample& s) { return !std::isfinite(s.log_white); });
    if (!primaries || samples[p].empty()) {
      return Error(ErrorCode::kBadData,
                   fmt::format("projector '{}': nowhere were its black and its red, green and blue seen together and "
                               "unclipped; shorten the exposures and photograph the ramps again",
                               input.projectors[p].name));
    }
  }
  if (!solve_vignetting(&samples, &result) || !solve_fields(input, &samples, &result)) {
    return Error(ErrorCode::kBadData, "the wall's light has no solution; photograph white at every stop again");
  }
  fit_black(input, samples, inverses, &result);
  return result;
}

}  // namespace cyclorama::photometry
