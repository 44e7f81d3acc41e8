// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/inter_reflection.h"

#include <Eigen/Dense>
#include <algorithm>
#include <numbers>

namespace cyclorama::simulated {
namespace {

constexpr int kPieces = 3;  // Subdivisions of a cell in each dimension.

struct Piece {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
};

std::vector<Piece> pieces_of(const TrueWall& wall, const WallPosition& low, const WallPosition& high) {
  std::vector<Piece> pieces;
  for (int j = 0; j < kPieces; ++j) {
    for (int i = 0; i < kPieces; ++i) {
      const auto at = wall.at({low.part, low.across + (high.across - low.across) * (i + 0.5) / kPieces,
                               low.along + (high.along - low.along) * (j + 0.5) / kPieces});
      pieces.push_back({at.point.xyz, at.normal});
    }
  }
  return pieces;
}

/// Form factor per area of the other piece: cos cos / (pi d^2); 0 if one piece is behind the other.
double exchange(const Piece& a, const Piece& b) {
  const Eigen::Vector3d between = b.point - a.point;
  const double distance2 = between.squaredNorm();
  const double from = a.normal.dot(between);
  const double to = -b.normal.dot(between);
  if (!(from > 0.0 && to > 0.0 && distance2 > 0.0)) return 0.0;
  return from * to / (std::numbers::pi * distance2 * distance2);
}

}  // namespace

struct InterReflection::Matrices {
  Eigen::MatrixXd form_factors;
  std::array<Eigen::MatrixXf, 3> answer;  ///< Maps direct to indirect light.
};

InterReflection::InterReflection(const TrueWall& wall, const WallCells& cells, const std::array<double, 3>& albedo) {
  const std::size_t n = cells.count();
  const auto size = static_cast<Eigen::Index>(n);
  std::vector<std::vector<Piece>> pieces;
  for (std::size_t i = 0; i < n; ++i) {
    areas_.push_back(wall.area_m2(cells.low(i), cells.high(i)));
    pieces.push_back(pieces_of(wall, cells.low(i), cells.high(i)));
  }
  auto made = std::make_unique<Matrices>();
  Eigen::MatrixXd exchanged = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i; j < n; ++j) {
      double sum = 0.0;
      int pairs = 0;
      for (std::size_t a = 0; a < pieces[i].size(); ++a) {
        for (std::size_t b = 0; b < pieces[j].size(); ++b) {
          if (i == j && a == b) continue;  // A point does not see itself.
          sum += exchange(pieces[i][a], pieces[j][b]);
          ++pairs;
        }
      }
      const auto row = static_cast<Eigen::Index>(i);
      const auto column = static_cast<Eigen::Index>(j);
      exchanged(row, column) = exchanged(column, row) = sum / pairs;
    }
  }
  const Eigen::VectorXd areas = Eigen::Map<const Eigen::VectorXd>(areas_.data(), size);
  // In a sharp corner the sum over pieces is slightly too large; scale it down to conserve energy.
  const double max = (exchanged * areas).maxCoeff();
  if (max > 1.0) exchanged /= max;
  made->form_factors = exchanged * areas.asDiagonal();
  for (std::size_t c = 0; c < 3; ++c) {
    if (c > 0 && albedo[c] == albedo[c - 1]) {
      made->answer[c] = made->answer[c - 1];
      continue;
    }
    const Eigen::MatrixXd bounced = albedo[c] * made->form_factors;
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(size, size) - bounced;
    // Computes F rho (1 - F rho)^-1; the factors commute.
    made->answer[c] = left.partialPivLu().solve(bounced).cast<float>();
  }
  matrices_ = std::move(made);
}

InterReflection::InterReflection(InterReflection&&) noexcept = default;
InterReflection& InterReflection::operator=(InterReflection&&) noexcept = default;
InterReflection::~InterReflection() = default;

InterReflection::Light InterReflection::indirect(const Light& direct) const {
  const auto n = static_cast<Eigen::Index>(direct.size());
  Light light(direct.size());
  for (std::size_t c = 0; c < 3; ++c) {
    Eigen::VectorXf from(n);
    for (std::size_t i = 0; i < direct.size(); ++i)
      from[static_cast<Eigen::Index>(i)] = static_cast<float>(direct[i][c]);
    const Eigen::VectorXf to = matrices_->answer[c] * from;
    for (std::size_t i = 0; i < direct.size(); ++i) light[i][c] = static_cast<double>(to[static_cast<Eigen::Index>(i)]);
  }
  return light;
}

double InterReflection::form_factor(std::size_t i, std::size_t j) const {
  return matrices_->form_factors(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
}

}  // namespace cyclorama::simulated
