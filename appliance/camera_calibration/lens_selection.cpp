// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/lens_selection.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cyclorama::camera_calibration {
namespace {

constexpr std::size_t kFolds = 5;
constexpr double kSameView = 0.02;          // Fraction of the picture's diagonal.
constexpr double kWorstFocal = 0.02;        // Maximum sigma of the focal length, relative to the focal length.
constexpr double kWorstDirection_px = 5.0;  // A lens with a larger uncertainty is refused.
constexpr double kFineDirection_px = 0.5;   // A larger uncertainty causes a remark.
constexpr calibration::LensModel kModels[] = {calibration::LensModel::kPinhole, calibration::LensModel::kRadial1,
                                              calibration::LensModel::kRadial2, calibration::LensModel::kDecentred,
                                              calibration::LensModel::kFull};

// A view is a stray if the lens of the others predicts it this many times worse than it predicts them, and by this.
constexpr double kStrayRatio = 4.0;
constexpr double kMinStray_px = 0.15;
constexpr std::size_t kMaxStrayShare = 5;  // At most one view of so many is a stray.

/// Error with which a lens predicts each view; infinite where it cannot.
std::vector<double> errors_of(const std::vector<LensView>& views, const calibration::MeasuredLens& lens) {
  std::vector<double> errors;
  for (const LensView& view : views) {
    const auto error = prediction_error_px(view, lens);
    errors.push_back(error ? *error : std::numeric_limits<double>::infinity());
  }
  return errors;
}

/// Returns the view that does not belong to the others, such as one with another zoom or of another board. The lens of
/// all views is bent by it, but fits it worst; the lens of the others predicts them well and it badly.
std::optional<std::size_t> stray_of(const std::vector<LensView>& views, int width_px, int height_px) {
  constexpr auto kModel = calibration::LensModel::kRadial2;
  const auto all = solve_lens(views, width_px, height_px, kModel);
  if (!all) return std::nullopt;
  const std::vector<double> bent = errors_of(views, all->lens);
  const auto suspect = static_cast<std::size_t>(std::ranges::max_element(bent) - bent.begin());
  std::vector<LensView> others = views;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(suspect));
  const auto fit = solve_lens(others, width_px, height_px, kModel, all->lens.values[calibration::MeasuredLens::kFocal]);
  if (!fit) return std::nullopt;
  std::vector<double> usual = errors_of(others, fit->lens);
  std::ranges::sort(usual);
  const auto error = prediction_error_px(views[suspect], fit->lens);
  const bool is_stray = error && *error > std::max(kMinStray_px, kStrayRatio * usual[usual.size() / 2]);
  return is_stray ? std::optional(suspect) : std::nullopt;
}

/// Leaves out views that do not belong to the others, with a remark.
void leave_out_strays(int width_px, int height_px, std::vector<LensView>* views, LensSelection* choice) {
  const std::size_t max_strays = views->size() / kMaxStrayShare;
  for (std::size_t count = 0; count < max_strays && views->size() > kMinViews; ++count) {
    const auto stray = stray_of(*views, width_px, height_px);
    if (!stray) return;
    choice->remarks.push_back(
        fmt::format("'{}' does not fit the other pictures and was left out; was it taken with another zoom, focus or "
                    "board?",
                    (*views)[*stray].name));
    std::erase(choice->used, (*views)[*stray].name);
    views->erase(views->begin() + static_cast<std::ptrdiff_t>(*stray));
  }
}

double heldout_px(const std::vector<LensView>& views, const calibration::MeasuredLens& lens,
                  calibration::LensModel model) {
  const std::size_t folds = std::min(kFolds, views.size());
  double squares = 0.0;
  for (std::size_t f = 0; f < folds; ++f) {
    std::vector<LensView> others;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (i % folds != f) others.push_back(views[i]);
    }
    const auto fit =
        solve_lens(others, lens.width_px, lens.height_px, model, lens.values[calibration::MeasuredLens::kFocal]);
    if (!fit) return std::numeric_limits<double>::infinity();
    for (std::size_t i = f; i < views.size(); i += folds) {
      const auto error = prediction_error_px(views[i], fit->lens);
      if (!error) return std::numeric_limits<double>::infinity();
      squares += *error * *error;
    }
  }
  return std::sqrt(squares / static_cast<double>(views.size()));
}

struct WorstPosition {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double sigma_px = 0.0;
};

/// Returns the largest uncertainty of a direction's pixel: the shift when the lens changes by one sigma along each
/// principal axis of the covariance.
WorstPosition worst_position(const calibration::MeasuredLens& lens) {
  WorstPosition worst;
  const Eigen::SelfAdjointEigenSolver<calibration::MeasuredLens::Covariance> axes(lens.covariance);
  const auto brown = lens.brown();
  if (!brown) return {Eigen::Vector2d::Zero(), std::numeric_limits<double>::infinity()};
  constexpr int kSteps = 4;
  for (int y = 0; y <= kSteps; ++y) {
    for (int x = 0; x <= kSteps; ++x) {
      const Eigen::Vector2d pixel(x * lens.width_px / static_cast<double>(kSteps),
                                  y * lens.height_px / static_cast<double>(kSteps));
      const auto d = calibration::direction_through(*brown, pixel);
      double square = d ? 0.0 : std::numeric_limits<double>::infinity();
      for (int axis = 0; d && axis < calibration::MeasuredLens::kParameters; ++axis) {
        const double sigma = std::sqrt(std::max(0.0, axes.eigenvalues()(axis)));
        if (!(sigma > 0.0)) continue;
        std::array<double, calibration::MeasuredLens::kParameters> moved = lens.values;
        for (int i = 0; i < calibration::MeasuredLens::kParameters; ++i) {
          moved[static_cast<std::size_t>(i)] += sigma * axes.eigenvectors()(i, axis);
        }
        Eigen::Vector2d there;
        calibration::project_through_lens(moved.data(), d->data(), there.data());
        square += (there - pixel).squaredNorm();
      }
      if (!(std::sqrt(square) <= worst.sigma_px)) worst = {pixel, std::sqrt(square)};
    }
  }
  return worst;
}

std::string part_of(const Eigen::Vector2d& pixel, int width_px, int height_px) {
  const double u = pixel.x() / width_px;
  const double v = pixel.y() / height_px;
  const std::string across = u < 0.34 ? "left" : u > 0.66 ? "right" : "middle";
  const std::string down = v < 0.34 ? "upper " : v > 0.66 ? "lower " : "";
  return down + across;
}

}  // namespace

bool is_new_view(const LensView& view, const std::vector<LensView>& others, int width_px, int height_px) {
  const double min = kSameView * std::hypot(width_px, height_px);
  return std::none_of(others.begin(), others.end(), [&](const LensView& other) {
    double sum = 0.0;
    std::size_t both = 0;
    for (std::size_t i = 0; i < view.board_m.size(); ++i) {
      for (std::size_t j = 0; j < other.board_m.size(); ++j) {
        if ((view.board_m[i] - other.board_m[j]).norm() > 1e-9) continue;
        sum += (view.camera_px[i] - other.camera_px[j]).norm();
        ++both;
      }
    }
    return 2 * both > std::min(view.board_m.size(), other.board_m.size()) && sum < min * static_cast<double>(both);
  });
}

Result<LensSelection> select_lens(const std::vector<LensView>& views, int width_px, int height_px) {
  LensSelection choice;
  std::vector<LensView> distinct;
  for (const LensView& view : views) {
    if (!is_new_view(view, distinct, width_px, height_px)) continue;
    distinct.push_back(view);
    choice.used.push_back(view.name);
  }
  if (distinct.size() < kMinViews) {
    return Error(ErrorCode::kBadData,
                 fmt::format("{} of {} pictures show the board differently enough, {} are needed; move it to other "
                             "parts of the picture, and turn it by 20 to 45 degrees",
                             distinct.size(), views.size(), kMinViews));
  }
  leave_out_strays(width_px, height_px, &distinct, &choice);
  double best = std::numeric_limits<double>::infinity();
  std::optional<Error> unsolved;
  std::vector<std::optional<LensFit>> fits;
  for (const calibration::LensModel model : kModels) {
    auto fit = solve_lens(distinct, width_px, height_px, model);
    LensTrial trial{model, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    if (fit) {
      trial.training_rms_px = fit->rms_px;
      trial.heldout_rms_px = heldout_px(distinct, fit->lens, model);
      fits.emplace_back(*std::move(fit));
    } else {
      if (fit.error().code() == ErrorCode::kInvalidArgument) return std::move(fit).error();
      if (!unsolved) unsolved = fit.error();
      fits.emplace_back();
    }
    best = std::min(best, trial.heldout_rms_px);
    choice.trials.push_back(trial);
  }
  std::size_t chosen = fits.size();
  for (std::size_t i = fits.size(); i-- > 0;) {
    if (fits[i] && choice.trials[i].heldout_rms_px * (1.0 - calibration::kMinModelGain) <= best) chosen = i;
  }
  if (chosen == fits.size() || !std::isfinite(best)) {
    if (unsolved) return *std::move(unsolved);
    return Error(ErrorCode::kBadData,
                 "without some of the pictures the others do not determine the lens; add some with the board turned by "
                 "20 to 45 degrees about its upright and about its level axis");
  }
  choice.model = kModels[chosen];
  choice.fit = *fits[chosen];
  choice.heldout_rms_px = choice.trials[chosen].heldout_rms_px;
  const calibration::MeasuredLens& lens = choice.fit.lens;
  const double focal = lens.values[calibration::MeasuredLens::kFocal];
  const double focal_sigma =
      std::sqrt(lens.covariance(calibration::MeasuredLens::kFocal, calibration::MeasuredLens::kFocal));
  if (!(focal_sigma <= kWorstFocal * focal)) {
    return Error(ErrorCode::kBadData,
                 fmt::format("the focal length is {:.0f} +- {:.0f} px, which is too uncertain; add pictures with the "
                             "board turned by 20 to 45 degrees about its upright and about its level axis",
                             focal, focal_sigma));
  }
  const WorstPosition worst = worst_position(lens);
  choice.worst_sigma_px = worst.sigma_px;
  const std::string where = part_of(worst.pixel, width_px, height_px);
  if (!(worst.sigma_px <= kWorstDirection_px)) {
    return Error(ErrorCode::kBadData,
                 fmt::format("directions at the picture's {} are not known to {:.0f} px; add pictures with the board "
                             "there, up to the picture's rim",
                             where, kWorstDirection_px));
  }
  if (worst.sigma_px > kFineDirection_px) {
    choice.remarks.push_back(
        fmt::format("directions at the picture's {} are known to {:.1f} px only; add pictures with the board there",
                    where, worst.sigma_px));
  }
  return choice;
}

}  // namespace cyclorama::camera_calibration
