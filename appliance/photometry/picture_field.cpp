// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/picture_field.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <utility>

#include "appliance/photometry/cubic_basis.h"

namespace cyclorama::photometry {
namespace {

constexpr double kAny = 1e-6;  // Weight of a prior of 0, which decides where there is no data.
constexpr double kSlack = 0.3;

struct Knots {
  int cells_x;
  int cells_y;
  [[nodiscard]] int columns() const { return cells_x + 3; }
  [[nodiscard]] int rows() const { return cells_y + 3; }
  [[nodiscard]] int count() const { return columns() * rows(); }
  [[nodiscard]] int at(int x, int y) const { return y * columns() + x; }
};

using Share = std::pair<int, double>;
std::array<Share, 16> shares_at(const Knots& knots, int width_px, int height_px, const Eigen::Vector2d& pixel) {
  const CubicWeights across = cubic_weights(pixel.x() / width_px * knots.cells_x, knots.cells_x);
  const CubicWeights down = cubic_weights(pixel.y() / height_px * knots.cells_y, knots.cells_y);
  std::array<Share, 16> shares;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      shares.at(static_cast<std::size_t>(4 * y + x)) = {
          knots.at(across.first + x, down.first + y),
          across.value.at(static_cast<std::size_t>(x)) * down.value.at(static_cast<std::size_t>(y))};
    }
  }
  return shares;
}

/// Adds the thin-plate energy: the second differences along both axes, and twice the mixed difference.
void add_bends(const Knots& knots, double weight, std::vector<Eigen::Triplet<double>>* entries) {
  const auto add = [&](std::initializer_list<Share> row, double factor) {
    for (const Share& a : row) {
      for (const Share& b : row) entries->emplace_back(a.first, b.first, weight * factor * a.second * b.second);
    }
  };
  for (int y = 0; y < knots.rows(); ++y) {
    for (int x = 0; x < knots.columns(); ++x) {
      if (x > 0 && x + 1 < knots.columns())
        add({{knots.at(x - 1, y), 1.0}, {knots.at(x, y), -2.0}, {knots.at(x + 1, y), 1.0}}, 1.0);
      if (y > 0 && y + 1 < knots.rows())
        add({{knots.at(x, y - 1), 1.0}, {knots.at(x, y), -2.0}, {knots.at(x, y + 1), 1.0}}, 1.0);
      if (x + 1 < knots.columns() && y + 1 < knots.rows()) {
        add({{knots.at(x, y), 1.0},
             {knots.at(x + 1, y), -1.0},
             {knots.at(x, y + 1), -1.0},
             {knots.at(x + 1, y + 1), 1.0}},
            2.0);
      }
    }
  }
}

}  // namespace

double PictureField::at(const Eigen::Vector2d& pixel) const {
  double sum = 0.0;
  for (const Share& share : shares_at({cells_x, cells_y}, width_px, height_px, pixel))
    sum += share.second * coefficients[static_cast<std::size_t>(share.first)];
  return std::clamp(sum, min, max);
}

struct FieldFit::State {
  int width_px;
  int height_px;
  Knots knots;
  std::vector<std::array<Share, 16>> shares;
  Eigen::VectorXd weights;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
};

FieldFit::FieldFit(int width_px, int height_px, int knot_px, double bend, std::span<const FieldSample> samples)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.width_px = width_px;
  s.height_px = height_px;
  s.knots = {std::max(1, (width_px + knot_px / 2) / knot_px), std::max(1, (height_px + knot_px / 2) / knot_px)};
  s.weights.resize(static_cast<Eigen::Index>(samples.size()));
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double weight = 1.0 / (samples[i].sigma * samples[i].sigma);
    s.weights(static_cast<Eigen::Index>(i)) = weight;
    s.shares.push_back(shares_at(s.knots, width_px, height_px, samples[i].pixel));
    for (const Share& a : s.shares.back()) {
      for (const Share& b : s.shares.back()) entries.emplace_back(a.first, b.first, weight * a.second * b.second);
    }
  }
  add_bends(s.knots, 1.0 / (bend * bend), &entries);
  for (int i = 0; i < s.knots.count(); ++i) entries.emplace_back(i, i, kAny);
  Eigen::SparseMatrix<double> matrix(s.knots.count(), s.knots.count());
  matrix.setFromTriplets(entries.begin(), entries.end());
  s.factor.compute(matrix);
}

FieldFit::~FieldFit() = default;
FieldFit::FieldFit(FieldFit&&) noexcept = default;
FieldFit& FieldFit::operator=(FieldFit&&) noexcept = default;

bool FieldFit::is_solved() const { return state_->factor.info() == Eigen::Success; }

PictureField FieldFit::fit(const Eigen::VectorXd& values) const {
  const State& s = *state_;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(s.knots.count());
  for (std::size_t i = 0; i < s.shares.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    for (const Share& share : s.shares[i]) right(share.first) += share.second * s.weights(at) * values(at);
  }
  const Eigen::VectorXd solved = s.factor.solve(right);
  PictureField field{s.width_px, s.height_px, s.knots.cells_x, s.knots.cells_y, {}, 0.0, 0.0};
  field.coefficients.assign(solved.begin(), solved.end());
  if (values.size() == 0) return field;
  // Some extrapolation is allowed, since the rim of a picture is never measured.
  const double slack = kSlack * (values.maxCoeff() - values.minCoeff());
  field.min = values.minCoeff() - slack;
  field.max = values.maxCoeff() + slack;
  return field;
}

}  // namespace cyclorama::photometry
