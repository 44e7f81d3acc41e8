// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/cell_means.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace cyclorama::solve {
namespace {

constexpr int kCellsPerPatch = 4;  // Per axis; over this many cells the wall is nearly flat.
constexpr std::size_t kMinPixelsInPatch = 8;
constexpr int kMinPixelsInCell = 3;
constexpr double kMadToSigma = 1.4826;
constexpr double kFarSigmas = 4.5;
constexpr double kMinSigma_px = 0.01;  // Lower bound, set by optics and decoding, for any number of pixels.

struct Item {
  Eigen::Vector2d camera;
  Eigen::Vector2d projector;
  double sigma_px = 0.0;
  bool is_used = true;
};

double median(std::vector<double>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

/// Local linear map: camera = at + slope * (projector - centre).
struct Patch {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Matrix2d slope = Eigen::Matrix2d::Identity();
};

bool fit(const std::vector<Item>& items, const Eigen::Vector2d& centre, Patch* ret_patch) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  std::size_t used = 0;
  for (const Item& item : items) {
    if (!item.is_used) continue;
    const Eigen::Vector3d row(1.0, item.projector.x() - centre.x(), item.projector.y() - centre.y());
    normal += row * row.transpose();
    right += row * item.camera.transpose();
    ++used;
  }
  if (used < kMinPixelsInPatch) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(normal);
  if (!(eigen.eigenvalues()(0) > 1e-9 * eigen.eigenvalues()(2))) return false;  // Collinear.
  const Eigen::Matrix<double, 3, 2> solved = normal.ldlt().solve(right);
  ret_patch->at = solved.row(0).transpose();
  ret_patch->slope = solved.bottomRows<2>().transpose();
  return solved.allFinite() && std::abs(ret_patch->slope.determinant()) > 1e-9;
}

/// Marks outliers, and fits the others. Returns true if enough items agree.
bool refuse_far_ones(const Eigen::Vector2d& centre, std::vector<Item>* items, Patch* ret_patch) {
  std::vector<double> us, vs;
  for (const Item& item : *items) {
    us.push_back(item.camera.x());
    vs.push_back(item.camera.y());
  }
  const Eigen::Vector2d middle(median(&us), median(&vs));
  std::vector<double> far;
  for (const Item& item : *items) far.push_back((item.camera - middle).norm());
  auto sorted = far;
  const double reach = 4.0 * median(&sorted) + 1.0;
  for (std::size_t i = 0; i < items->size(); ++i) (*items)[i].is_used = far[i] <= reach;
  for (int round = 0; round < 3; ++round) {
    if (!fit(*items, centre, ret_patch)) return false;
    const Eigen::Matrix2d to_projector = ret_patch->slope.inverse();
    std::vector<double> errors;
    for (Item& item : *items) {
      const Eigen::Vector2d expected = ret_patch->at + ret_patch->slope * (item.projector - centre);
      errors.push_back((to_projector * (item.camera - expected)).norm() / item.sigma_px);
    }
    std::vector<double> used;
    for (std::size_t i = 0; i < items->size(); ++i) {
      if ((*items)[i].is_used) used.push_back(errors[i]);
    }
    // The length of a vector of two normal errors has a median of 1.18 sigma.
    const double limit = kFarSigmas * std::max(1.0, median(&used) * kMadToSigma / 1.18 * 0.8);
    for (std::size_t i = 0; i < items->size(); ++i) (*items)[i].is_used = errors[i] <= limit;
  }
  return fit(*items, centre, ret_patch);
}

class Averager {
 public:
  Averager(const Measurements& measurements, int cell_px, CellMeans* ret_means)
      : measurements_(measurements), cell_px_(cell_px), means_(ret_means) {}

  void add(int projector, int direction) {
    const MeasuredProjector& format = measurements_.projectors[static_cast<std::size_t>(projector)];
    const int patch_px = cell_px_ * kCellsPerPatch;
    const int columns = (format.width_px + patch_px - 1) / patch_px;
    const int rows = (format.height_px + patch_px - 1) / patch_px;
    std::vector<std::vector<Item>> patches(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (const Correspondence& c : measurements_.directions[static_cast<std::size_t>(direction)].correspondences) {
      if (c.projector != static_cast<std::uint32_t>(projector)) continue;
      if (!(c.projector_x >= 0.0f && c.projector_x < static_cast<float>(format.width_px) && c.projector_y >= 0.0f &&
            c.projector_y < static_cast<float>(format.height_px))) {
        ++means_->refused;
        continue;
      }
      const auto column = static_cast<int>(c.projector_x) / patch_px;
      const auto row = static_cast<int>(c.projector_y) / patch_px;
      patches[static_cast<std::size_t>(row * columns + column)].push_back(
          {{static_cast<double>(c.camera_u), static_cast<double>(c.camera_v)},
           {static_cast<double>(c.projector_x), static_cast<double>(c.projector_y)},
           static_cast<double>(c.sigma_px)});
    }
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        auto& items = patches[static_cast<std::size_t>(row * columns + column)];
        const Eigen::Vector2d centre((column + 0.5) * patch_px, (row + 0.5) * patch_px);
        Patch patch;
        if (items.size() < kMinPixelsInPatch || !refuse_far_ones(centre, &items, &patch)) {
          means_->refused += items.size();
          continue;
        }
        add_cells(projector, direction, column, row, items, patch);
      }
    }
  }

 private:
  void add_cells(int projector, int direction, int column, int row, const std::vector<Item>& items,
                 const Patch& patch) {
    struct Sum {
      Eigen::Vector2d camera = Eigen::Vector2d::Zero();
      double square_error = 0.0;
      double variance = 0.0;
      int count = 0;
    };
    Sum sums[kCellsPerPatch * kCellsPerPatch];
    const Eigen::Vector2d corner(column * kCellsPerPatch * cell_px_, row * kCellsPerPatch * cell_px_);
    const Eigen::Vector2d centre = corner.array() + 0.5 * kCellsPerPatch * cell_px_;
    const Eigen::Matrix2d to_projector = patch.slope.inverse();
    const auto centre_of = [&](int x, int y) -> Eigen::Vector2d {
      return corner + cell_px_ * Eigen::Vector2d(x + 0.5, y + 0.5);
    };
    for (const Item& item : items) {
      if (!item.is_used) {
        ++means_->refused;
        continue;
      }
      const int x = std::clamp(static_cast<int>((item.projector.x() - corner.x()) / cell_px_), 0, kCellsPerPatch - 1);
      const int y = std::clamp(static_cast<int>((item.projector.y() - corner.y()) / cell_px_), 0, kCellsPerPatch - 1);
      Sum& sum = sums[y * kCellsPerPatch + x];
      sum.camera += item.camera - patch.slope * (item.projector - centre_of(x, y));
      const Eigen::Vector2d expected = patch.at + patch.slope * (item.projector - centre);
      sum.square_error += 0.5 * (to_projector * (item.camera - expected)).squaredNorm();
      sum.variance += item.sigma_px * item.sigma_px;
      ++sum.count;
      ++means_->used;
    }
    const int lattice_columns =
        (measurements_.projectors[static_cast<std::size_t>(projector)].width_px + cell_px_ - 1) / cell_px_;
    for (int y = 0; y < kCellsPerPatch; ++y) {
      for (int x = 0; x < kCellsPerPatch; ++x) {
        const Sum& sum = sums[y * kCellsPerPatch + x];
        if (sum.count < kMinPixelsInCell) continue;
        CellMean mean;
        mean.direction = direction;
        mean.projector = projector;
        mean.cell = (row * kCellsPerPatch + y) * lattice_columns + column * kCellsPerPatch + x;
        mean.projector_px = centre_of(x, y);
        mean.camera_px = sum.camera / sum.count;
        mean.camera_per_projector = patch.slope;
        const double variance = std::max(sum.variance, sum.square_error) / sum.count;
        mean.sigma_px = std::max(kMinSigma_px, std::sqrt(variance / sum.count));
        means_->cells.push_back(mean);
      }
    }
  }

  const Measurements& measurements_;
  int cell_px_;
  CellMeans* means_;
};

}  // namespace

CellMeans average_cells(const Measurements& measurements, int cell_px) {
  CHECK(cell_px >= 2);
  CellMeans means;
  means.cell_px = cell_px;
  Averager averager(measurements, cell_px, &means);
  for (std::size_t p = 0; p < measurements.projectors.size(); ++p) {
    for (std::size_t d = 0; d < measurements.directions.size(); ++d) {
      averager.add(static_cast<int>(p), static_cast<int>(d));
    }
  }
  return means;
}

int fitting_cell_px(const Measurements& measurements) {
  // The median density over blocks of 64 pixels that a direction lights at all.
  constexpr int kBlock_px = 64;
  std::vector<double> counts;
  for (const TurntableDirection& direction : measurements.directions) {
    std::vector<std::vector<int>> blocks(measurements.projectors.size());
    for (std::size_t p = 0; p < blocks.size(); ++p) {
      const MeasuredProjector& format = measurements.projectors[p];
      blocks[p].assign(static_cast<std::size_t>((format.width_px / kBlock_px + 1) * (format.height_px / kBlock_px + 1)),
                       0);
    }
    for (const Correspondence& c : direction.correspondences) {
      const MeasuredProjector& format = measurements.projectors[c.projector];
      if (!(c.projector_x >= 0.0f && c.projector_x < static_cast<float>(format.width_px) && c.projector_y >= 0.0f &&
            c.projector_y < static_cast<float>(format.height_px))) {
        continue;
      }
      const int column = static_cast<int>(c.projector_x) / kBlock_px;
      const int row = static_cast<int>(c.projector_y) / kBlock_px;
      ++blocks[c.projector][static_cast<std::size_t>(row * (format.width_px / kBlock_px + 1) + column)];
    }
    for (const auto& of_projector : blocks) {
      for (const int count : of_projector) {
        if (count > 0) counts.push_back(count);
      }
    }
  }
  if (counts.empty()) return 8;
  const double per_px = median(&counts) / (kBlock_px * kBlock_px);
  constexpr double kWanted = 6.0;
  for (const int cell : {8, 16, 32}) {
    if (per_px * cell * cell >= kWanted) return cell;
  }
  return 64;
}

}  // namespace cyclorama::solve
