// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/turntable_adjustment.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace cyclorama::solve {
namespace {

constexpr double kLoss_sigmas = 2.5;
constexpr double kTurn_rad = 0.05;  // Prior sigma of the rotation of known directions.
// Prior sigma of the correction to a fitted wall's inverse depth, relative to the inverse depth straight ahead.
constexpr double kWallTrust = 0.03;

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  const double min = 1e-24 + 1e-18 * std::max(0.0, eigen.eigenvalues().maxCoeff());
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(min).cwiseInverse().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Returns two unit vectors perpendicular to `d`.
Eigen::Matrix<double, 3, 2> tangent_of(const Eigen::Vector3d& d) {
  Eigen::Index min = 0;
  d.cwiseAbs().minCoeff(&min);
  Eigen::Matrix<double, 3, 2> tangent;
  tangent.col(0) = d.cross(Eigen::Vector3d::Unit(min)).normalized();
  tangent.col(1) = d.cross(tangent.col(0));
  return tangent;
}

bool is_definite(const Eigen::Matrix2d& m) { return m(0, 0) > 0.0 && m(1, 1) > 0.0 && m.determinant() > 0.0; }

}  // namespace

TurntableAdjustment::TurntableAdjustment(const TurntableTask& task, const TurntableHints& hints, bool with_offset,
                                         const std::vector<const Track*>& tracks, TurntableState* state)
    : measurements_(task.measurements), options_(task.options), reference_(task.reference), state_(state) {
  bool with_turn = false;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    TrackData data;
    data.first_observation = observations_.size();
    data.observations = tracks[t]->cells.size();
    data.wall_inverse_depth = state->inverse_depth.wall_at(Eigen::Vector3d(state->directions[t].data()));
    for (const std::size_t i : tracks[t]->cells) {
      const CellMean& cell = task.means.cells[i];
      observations_.push_back({TurntableObservation(cell), static_cast<std::size_t>(cell.direction)});
    }
    const CellMean& cell = task.means.cells[tracks[t]->cells.front()];
    if (with_offset && hints.known) {
      data.known = hints.known(static_cast<std::size_t>(cell.projector), cell.projector_px);
    }
    with_turn = with_turn || data.known;
    tracks_.push_back(data);
  }
  choose_shared(with_offset, with_turn);
  const auto count = static_cast<Eigen::Index>(shared_.size());
  prior_means_ = Eigen::VectorXd::Zero(count);
  prior_normal_ = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Shared& shared = shared_[static_cast<std::size_t>(i)];
    const double sigma = prior_sigma(shared);
    prior_normal_(i, i) = 1.0 / (sigma * sigma);
    if (shared.kind == Shared::kLens) prior_means_[i] = measurements_.camera.values[shared.index];
    if (shared.kind == Shared::kMount && shared.index == 0) prior_means_[i] = measurements_.pitch_rad;
    if (shared.kind == Shared::kAngle) prior_means_[i] = measurements_.directions[shared.index].angle_rad;
    if (shared.kind == Shared::kInverseDepth && shared.index == 0 && state->inverse_depth.wall == nullptr) {
      prior_means_[i] = 1.0 / measurements_.wall_distance_m;
    }
  }
  if (!shared_.empty() && shared_.front().kind == Shared::kLens) {
    prior_normal_.topLeftCorner<calibration::MeasuredLens::kParameters, calibration::MeasuredLens::kParameters>() =
        inverse_of(measurements_.camera.covariance);
  }
}

void TurntableAdjustment::choose_shared(bool with_offset, bool with_turn) {
  columns_.assign(kAngleIndex, -1);
  const auto add = [&](Shared::Kind kind, int first, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      columns_[static_cast<std::size_t>(first) + i] = static_cast<Eigen::Index>(shared_.size());
      shared_.push_back({kind, i});
    }
  };
  if (measurements_.camera.covariance.diagonal().maxCoeff() > 0.0) {
    add(Shared::kLens, kLensIndex, calibration::MeasuredLens::kParameters);
  }
  add(Shared::kMount, kMountIndex, 2);
  if (with_offset) add(Shared::kOffset, kOffsetIndex, 2);
  if (with_offset) add(Shared::kInverseDepth, kInverseDepthIndex, calibration::kInverseDepthTerms);
  if (with_turn) {
    turn_column_ = static_cast<Eigen::Index>(shared_.size());
    for (std::size_t i = 0; i < 3; ++i) shared_.push_back({Shared::kTurn, i});
  }
  angle_columns_.assign(state_->angles.size(), -1);
  std::vector<bool> is_seen(state_->angles.size(), false);
  for (const TrackObservation& observation : observations_) is_seen[observation.direction] = true;
  for (std::size_t d = 0; d < is_seen.size(); ++d) {
    if (!is_seen[d] || d == reference_) continue;
    angle_columns_[d] = static_cast<Eigen::Index>(shared_.size());
    shared_.push_back({Shared::kAngle, d});
  }
}

double* TurntableAdjustment::number(TurntableState* state, const Shared& shared) const {
  switch (shared.kind) {
    case Shared::kLens:
      return &state->lens[shared.index];
    case Shared::kMount:
      return &state->mount[shared.index];
    case Shared::kOffset:
      return &state->offset[shared.index];
    case Shared::kInverseDepth:
      return &state->inverse_depth.terms[shared.index];
    case Shared::kTurn:
      return &state->turn[shared.index];
    case Shared::kAngle:
      return &state->angles[shared.index];
  }
  CHECK(false);
}

double TurntableAdjustment::prior_sigma(const Shared& shared) const {
  const double distance = measurements_.wall_distance_m;
  const auto i = static_cast<Eigen::Index>(shared.index);
  switch (shared.kind) {
    case Shared::kLens:
      return std::max(1e-12, std::sqrt(measurements_.camera.covariance(i, i)));
    case Shared::kMount:
      return options_.mount_sigma_rad;
    case Shared::kOffset:
      return options_.offset_sigma_m;
    case Shared::kInverseDepth:
      if (state_->inverse_depth.wall != nullptr) return kWallTrust / distance;
      return measurements_.wall_distance_sigma_m / (distance * distance);
    case Shared::kTurn:
      return kTurn_rad;
    case Shared::kAngle:
      return measurements_.directions[shared.index].sigma_rad;
  }
  CHECK(false);
}

Eigen::VectorXd TurntableAdjustment::shared_numbers(TurntableState* state) const {
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(shared_.size()));
  for (std::size_t i = 0; i < shared_.size(); ++i) {
    numbers[static_cast<Eigen::Index>(i)] = *number(state, shared_[i]);
  }
  return numbers;
}

Eigen::Index TurntableAdjustment::column_of(int parameter_index, std::size_t direction) const {
  return parameter_index == kAngleIndex ? angle_columns_[direction]
                                        : columns_[static_cast<std::size_t>(parameter_index)];
}

std::optional<double> TurntableAdjustment::add_measured(TurntableState* state, bool with_known, Equations* ret) const {
  using ObservationNormal = Eigen::Matrix<double, kObservationParameters, kObservationParameters>;
  using ObservationGradient = Eigen::Matrix<double, kObservationParameters, 1>;
  std::vector<SeenFrom> cameras;
  for (const double angle : state->angles) cameras.emplace_back(state->mount, state->offset, angle);
  // All observations of a direction have the same shared parameters, so their terms are summed before they are added to
  // the equations.
  std::vector<ObservationNormal> normals;
  std::vector<ObservationGradient> gradients;
  if (ret != nullptr) {
    normals.assign(cameras.size(), ObservationNormal::Zero());
    gradients.assign(cameras.size(), ObservationGradient::Zero());
    const auto count = static_cast<Eigen::Index>(shared_.size());
    ret->gradient = Eigen::VectorXd::Zero(count);
    ret->normal = Eigen::MatrixXd::Zero(count, count);
    ret->tracks.assign(tracks_.size(), {});
    ret->crosses.resize(observations_.size());
  }
  double cost = 0.0;
  SeenFrom::Slopes slopes;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const TrackData& track = tracks_[t];
    const Eigen::Vector3d direction(state->directions[t].data());
    TrackEquations* own = ret != nullptr ? &ret->tracks[t] : nullptr;
    if (own != nullptr) own->tangent = tangent_of(direction);
    for (std::size_t s = track.first_observation; s < track.first_observation + track.observations; ++s) {
      const TrackObservation& seen = observations_[s];
      Eigen::Vector2d error;
      if (!cameras[seen.direction].residuals(seen.observation, state->lens.data(), state->inverse_depth.terms,
                                             track.wall_inverse_depth, direction, &error,
                                             own != nullptr ? &slopes : nullptr)) {
        return std::nullopt;
      }
      const WeighedSquare share = weighed(loss_, kLoss_sigmas, error.squaredNorm());
      cost += share.cost;
      if (own == nullptr) continue;
      const Eigen::Matrix2d by_own = slopes.by_direction * own->tangent;
      const Eigen::Matrix2d weighed_own = share.weight * by_own.transpose();
      const ObservationCross weighed_numbers = share.weight * slopes.by_numbers;
      own->own += weighed_own * by_own;
      own->own_gradient += weighed_own * error;
      ret->crosses[s] = weighed_own * slopes.by_numbers;
      const ObservationGradient across = weighed_numbers.row(0);
      const ObservationGradient down = weighed_numbers.row(1);
      for (int j = 0; j < kObservationParameters; ++j) {
        normals[seen.direction].col(j) += slopes.by_numbers(0, j) * across + slopes.by_numbers(1, j) * down;
      }
      gradients[seen.direction] += error[0] * across + error[1] * down;
    }
    if (!track.known || !with_known) continue;
    // A linear rotation suffices, since a first estimate of the rotation was applied before.
    const Eigen::Vector3d& told = track.known->direction;
    const Eigen::Vector3d turn(state->turn.data());
    const double per_sigma = 1.0 / track.known->sigma_rad;
    const Eigen::Vector3d error = per_sigma * (told + turn.cross(told) - direction);
    const WeighedSquare share = weighed(loss_, kLoss_sigmas, error.squaredNorm());
    cost += share.cost;
    if (own == nullptr) continue;
    Eigen::Matrix3d by_turn;
    for (int i = 0; i < 3; ++i) by_turn.col(i) = per_sigma * Eigen::Vector3d::Unit(i).cross(told);
    const Eigen::Matrix<double, 3, 2> by_own = -per_sigma * own->tangent;
    own->own += share.weight * by_own.transpose() * by_own;
    own->own_gradient += share.weight * by_own.transpose() * error;
    own->by_turn = share.weight * by_own.transpose() * by_turn;
    ret->normal.block<3, 3>(turn_column_, turn_column_) += share.weight * by_turn.transpose() * by_turn;
    ret->gradient.segment<3>(turn_column_) += share.weight * by_turn.transpose() * error;
  }
  for (std::size_t d = 0; d < normals.size(); ++d) {
    for (int i = 0; i < kObservationParameters; ++i) {
      const Eigen::Index row = column_of(i, d);
      if (row < 0) continue;
      ret->gradient[row] += gradients[d][i];
      for (int j = 0; j <= i; ++j) {  // Columns ascend; the angle's column is the last.
        const Eigen::Index column = column_of(j, d);
        if (column >= 0) ret->normal(row, column) += normals[d](i, j);
      }
    }
  }
  return cost;
}

double TurntableAdjustment::add_priors(TurntableState* state, Eigen::VectorXd* ret_gradient,
                                       Eigen::MatrixXd* ret_normal) const {
  const Eigen::VectorXd off = shared_numbers(state) - prior_means_;
  const Eigen::VectorXd slope = prior_normal_ * off;
  if (ret_gradient != nullptr) *ret_gradient += slope;
  if (ret_normal != nullptr) *ret_normal += prior_normal_;
  return 0.5 * off.dot(slope);
}

std::optional<double> TurntableAdjustment::linearise() {
  const auto cost = add_measured(state_, true, &equations_);
  if (!cost) return std::nullopt;
  const double priors = add_priors(state_, &equations_.gradient, &equations_.normal);
  return std::isfinite(*cost + priors) ? std::optional(*cost + priors) : std::nullopt;
}

void TurntableAdjustment::cross_of(const Equations& equations, std::size_t track,
                                   std::vector<Eigen::Index>* ret_columns, Eigen::Matrix2Xd* ret_cross) const {
  // The order is: shared parameters, rotation, one angle per direction.
  const TrackData& data = tracks_[track];
  ret_columns->clear();
  for (const Eigen::Index position : columns_) {
    if (position >= 0) ret_columns->push_back(position);
  }
  const auto common = static_cast<Eigen::Index>(ret_columns->size());
  for (Eigen::Index i = 0; turn_column_ >= 0 && i < 3; ++i) ret_columns->push_back(turn_column_ + i);
  for (std::size_t s = data.first_observation; s < data.first_observation + data.observations; ++s) {
    const Eigen::Index angle = angle_columns_[observations_[s].direction];
    if (angle >= 0) ret_columns->push_back(angle);
  }
  ret_cross->setZero(2, static_cast<Eigen::Index>(ret_columns->size()));
  Eigen::Index next = common;
  if (turn_column_ >= 0) ret_cross->middleCols<3>(next) = equations.tracks[track].by_turn;
  if (turn_column_ >= 0) next += 3;
  for (std::size_t s = data.first_observation; s < data.first_observation + data.observations; ++s) {
    const ObservationCross& cross = equations.crosses[s];
    Eigen::Index column = 0;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i] >= 0) ret_cross->col(column++) += cross.col(static_cast<Eigen::Index>(i));
    }
    if (angle_columns_[observations_[s].direction] >= 0) ret_cross->col(next++) = cross.col(kAngleIndex);
  }
}

TurntableAdjustment::Elimination TurntableAdjustment::eliminated(const Equations& equations, double damping) const {
  Elimination left{equations.normal, equations.gradient};
  left.normal.diagonal() += damping_of(equations.normal.diagonal(), damping);
  std::vector<Eigen::Index> columns;
  Eigen::Matrix2Xd cross;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const TrackEquations& track = equations.tracks[t];
    Eigen::Matrix2d own = track.own;
    own.diagonal() += damping_of(track.own.diagonal(), damping);
    if (!is_definite(own)) continue;
    cross_of(equations, t, &columns, &cross);
    const Eigen::Matrix2d inverse = own.inverse();
    const Eigen::Matrix2Xd solved = inverse * cross;
    const Eigen::Vector2d solved_gradient = inverse * track.own_gradient;
    // Columns ascend except for angles, which follow the track's order.
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto a = static_cast<Eigen::Index>(i);
      left.gradient[columns[i]] -= cross.col(a).dot(solved_gradient);
      for (std::size_t j = 0; j < columns.size(); ++j) {
        if (columns[j] > columns[i]) continue;
        left.normal(columns[i], columns[j]) -= cross.col(a).dot(solved.col(static_cast<Eigen::Index>(j)));
      }
    }
  }
  return left;
}

std::optional<DampedProblem::Attempt> TurntableAdjustment::attempt(double damping) {
  const Elimination left = eliminated(equations_, damping);
  const Eigen::LLT<Eigen::MatrixXd> factor(left.normal);  // Reads the lower triangle.
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd step = factor.solve(-left.gradient);
  if (!step.allFinite()) return std::nullopt;
  candidate_ = *state_;
  for (std::size_t i = 0; i < shared_.size(); ++i) {
    *number(&candidate_, shared_[i]) += step[static_cast<Eigen::Index>(i)];
  }
  // The predicted decrease is -g'x - x'Nx / 2, which equals (x'Dx - g'x) / 2 if (N + D) x = -g.
  const Eigen::VectorXd damped = damping_of(equations_.normal.diagonal(), damping);
  double predicted = 0.5 * (step.dot(damped.cwiseProduct(step)) - equations_.gradient.dot(step));
  double squares = step.squaredNorm();
  std::vector<Eigen::Index> columns;
  Eigen::Matrix2Xd cross;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const TrackEquations& track = equations_.tracks[t];
    const Eigen::Vector2d damped_own = damping_of(track.own.diagonal(), damping);
    Eigen::Matrix2d own = track.own;
    own.diagonal() += damped_own;
    if (!is_definite(own)) continue;
    cross_of(equations_, t, &columns, &cross);
    Eigen::Vector2d right = track.own_gradient;
    for (std::size_t i = 0; i < columns.size(); ++i)
      right += step[columns[i]] * cross.col(static_cast<Eigen::Index>(i));
    const Eigen::Vector2d aside = -own.inverse() * right;
    Eigen::Map<Eigen::Vector3d> direction(candidate_.directions[t].data());
    direction = (direction + track.tangent * aside).normalized();
    predicted += 0.5 * (aside.dot(damped_own.cwiseProduct(aside)) - track.own_gradient.dot(aside));
    squares += aside.squaredNorm();
  }
  const auto cost = add_measured(&candidate_, true, nullptr);
  if (!cost) return std::nullopt;
  const double size = std::hypot(shared_numbers(state_).norm(), std::sqrt(static_cast<double>(tracks_.size())));
  return Attempt{*cost + add_priors(&candidate_, nullptr, nullptr), predicted, std::sqrt(squares) / size};
}

Eigen::MatrixXd TurntableAdjustment::reduced_normal(bool measured_alone) const {
  Equations equations;
  if (!add_measured(state_, !measured_alone, &equations)) return prior_normal_;
  if (!measured_alone) add_priors(state_, nullptr, &equations.normal);
  return eliminated(equations, 0.0).normal;
}

std::vector<std::string> TurntableAdjustment::names() const {
  static constexpr const char* kLens[] = {"focal_px", "centre_u_px", "centre_v_px", "k1", "k2", "k3", "p1", "p2"};
  static constexpr const char* kMount[] = {"pitch_rad", "roll_rad"};
  static constexpr const char* kOffset[] = {"offset_right_m", "offset_forward_m"};
  static constexpr const char* kTurn[] = {"turn_right_rad", "turn_up_rad", "turn_back_rad"};
  std::vector<std::string> names;
  for (const Shared& shared : shared_) {
    switch (shared.kind) {
      case Shared::kLens:
        names.emplace_back(kLens[shared.index]);
        break;
      case Shared::kMount:
        names.emplace_back(kMount[shared.index]);
        break;
      case Shared::kOffset:
        names.emplace_back(kOffset[shared.index]);
        break;
      case Shared::kInverseDepth:
        names.push_back(fmt::format("inverse_depth_{}_per_m", shared.index));
        break;
      case Shared::kTurn:
        names.emplace_back(kTurn[shared.index]);
        break;
      case Shared::kAngle:
        names.push_back(fmt::format("angle_{}_rad", shared.index));
        break;
    }
  }
  return names;
}

std::vector<double> TurntableAdjustment::prior_sigmas() const {
  std::vector<double> sigmas;
  for (const Shared& shared : shared_) sigmas.push_back(prior_sigma(shared));
  return sigmas;
}

}  // namespace cyclorama::solve
