// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/model_selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <map>

namespace cyclorama::solve {
namespace {

constexpr double kBlock_px = 96.0;
constexpr double kFlat_sigmas = 3.0;
constexpr int kFoldSteps = 15;
// Lens model of the projectors with which wall models are compared first.
constexpr calibration::LensModel kWallsLens = calibration::LensModel::kRadial1;
// Wall models are compared again with a richer lens model if that reduces the left-out error by at least this factor; a
// smaller decrease is chance.
constexpr double kLensMatters = 1.02;
// The search ends at a model whose left-out error is at most this multiple of the measurements' noise, if the next
// model does not improve it. The first condition alone is not enough: an error below the noise of one sample is
// significant over a thousand samples.
constexpr double kAsGoodAsNoise = 1.25;

int fold_of(const MapSample& sample, int folds) {
  const auto column = static_cast<unsigned>(std::max(0.0, sample.projector_px.x()) / kBlock_px);
  const auto row = static_cast<unsigned>(std::max(0.0, sample.projector_px.y()) / kBlock_px);
  const unsigned hash =
      (column * 2654435761U) ^ (row * 2246822519U) ^ (static_cast<unsigned>(sample.projector) * 3266489917U);
  return static_cast<int>((hash >> 9) % static_cast<unsigned>(folds));
}

struct Tried {
  calibration::ModelTrial trial;
  calibration::SurfaceFit fit;
};

class ModelSelection {
 public:
  ModelSelection(const std::vector<MeasuredProjector>& projectors, std::span<const MapSample> samples,
                 const ModelOptions& options)
      : projectors_(projectors), samples_(samples), options_(options) {
    training_.resize(static_cast<std::size_t>(options.folds));
    left_out_.resize(static_cast<std::size_t>(options.folds));
    for (const MapSample& sample : samples) {
      const int own = fold_of(sample, options.folds);
      for (int f = 0; f < options.folds; ++f) {
        (f == own ? left_out_ : training_)[static_cast<std::size_t>(f)].push_back(sample);
      }
    }
  }

  /// Fits from several starts, then fits the folds from the best result.
  Tried attempt(std::string name, int parameters, const std::vector<calibration::SurfaceFit>& starts,
                calibration::LensModel lens) const {
    Tried tried;
    tried.trial = {std::move(name), parameters, 0.0, 0.0, 0.0, false};
    bool is_any = false;
    std::vector<std::future<Result<calibration::SurfaceFit>>> attempts;
    for (const calibration::SurfaceFit& start : starts) {
      attempts.push_back(std::async(std::launch::async, [&] {
        return fit_surface(projectors_, samples_, start, {lens, false, 50});
      }));
    }
    for (auto& one : attempts) {
      auto fit = one.get();
      if (!fit || (is_any && fit->cost >= tried.fit.cost)) continue;
      tried.fit = *std::move(fit);
      is_any = true;
    }
    if (!is_any) return tried;
    tried.trial.training_rms_px = prediction_error_px(tried.fit, samples_);
    double squares = 0.0;
    double weight = 0.0;
    std::vector<calibration::SurfaceFit> folds;
    std::vector<std::future<Result<calibration::SurfaceFit>>> fits;
    for (const std::vector<MapSample>& training : training_) {
      fits.push_back(std::async(std::launch::async, [&] {
        return fit_surface(projectors_, training, tried.fit, {lens, false, kFoldSteps, false});
      }));
    }
    std::vector<Result<calibration::SurfaceFit>> fitted;
    for (auto& fit : fits) fitted.push_back(fit.get());
    for (std::size_t f = 0; f < training_.size(); ++f) {
      const auto& fit = fitted[f];
      if (left_out_[f].empty() || training_[f].empty()) continue;
      if (!fit) return tried;
      const double error = prediction_error_px(*fit, left_out_[f]);
      squares += error * error * static_cast<double>(left_out_[f].size());
      weight += static_cast<double>(left_out_[f].size());
      folds.push_back(*fit);
    }
    tried.trial.heldout_rms_px = weight > 0.0 ? std::sqrt(squares / weight) : 0.0;
    tried.trial.scatter = scatter_of(folds);
    tried.trial.is_usable =
        weight > 0.0 && std::isfinite(tried.trial.heldout_rms_px) && tried.trial.scatter <= options_.max_scatter;
    return tried;
  }

 private:
  [[nodiscard]] double scatter_of(const std::vector<calibration::SurfaceFit>& folds) const {
    double squares = 0.0;
    double count = 0.0;
    const std::size_t step = std::max<std::size_t>(1, samples_.size() / 200);
    for (std::size_t i = 0; i < samples_.size(); i += step) {
      double sum = 0.0;
      double square_sum = 0.0;
      for (const calibration::SurfaceFit& fold : folds) {
        const double inverse_depth = fold.surface.inverse_depth_at(samples_[i].direction).value_or(0.0);
        sum += inverse_depth;
        square_sum += inverse_depth * inverse_depth;
      }
      const double n = static_cast<double>(folds.size());
      const double mean = sum / n;
      if (!(mean > 0.0)) continue;
      squares += std::max(0.0, square_sum / n - mean * mean) / (mean * mean);
      count += 1.0;
    }
    return count > 0.0 ? std::sqrt(squares / count) : 1.0;
  }

  const std::vector<MeasuredProjector>& projectors_;
  std::span<const MapSample> samples_;
  const ModelOptions& options_;
  std::vector<std::vector<MapSample>> training_;
  std::vector<std::vector<MapSample>> left_out_;
};

calibration::SurfaceFit richer(const calibration::SurfaceFit& from, calibration::SurfaceModel model,
                               const std::vector<Eigen::Vector3d>& spread, double knot_rad) {
  calibration::SurfaceFit start = from;
  start.surface = calibration::Surface::start(model, from.surface, spread, knot_rad);
  return start;
}

/// Returns starts for a model from the results of smaller models.
std::vector<calibration::SurfaceFit> starts_of(calibration::SurfaceModel model, const calibration::SurfaceFit& first,
                                               const std::map<calibration::SurfaceModel, Tried>& tried,
                                               const std::vector<Eigen::Vector3d>& spread, double knot_rad) {
  const auto found = [&](calibration::SurfaceModel smaller) -> const calibration::SurfaceFit* {
    const auto at = tried.find(smaller);
    return at != tried.end() && !at->second.fit.projectors.empty() ? &at->second.fit : nullptr;
  };
  const calibration::SurfaceFit& plane =
      found(calibration::SurfaceModel::kPlane) != nullptr ? *found(calibration::SurfaceModel::kPlane) : first;
  const calibration::SurfaceFit& cylinder =
      found(calibration::SurfaceModel::kCylinder) != nullptr ? *found(calibration::SurfaceModel::kCylinder) : plane;
  std::vector<calibration::SurfaceFit> starts;
  const double round = 1.0 / first.surface.distance_m;
  const auto bent = [&](double curvature) {
    calibration::SurfaceFit start = richer(first, calibration::SurfaceModel::kCylinder, spread, knot_rad);
    start.surface.parameters[3] = curvature;
    return start;
  };
  switch (model) {
    case calibration::SurfaceModel::kPlane:
      starts.push_back(first);
      break;
    case calibration::SurfaceModel::kCylinder:
      starts.push_back(richer(plane, model, spread, knot_rad));
      for (const double curvature : {round, 0.4 * round}) starts.push_back(bent(curvature));
      break;
    case calibration::SurfaceModel::kQuadric:
      starts.push_back(richer(cylinder, model, spread, knot_rad));
      starts.push_back(richer(bent(round), model, spread, knot_rad));
      if (const calibration::SurfaceFit* profile = found(calibration::SurfaceModel::kProfile); profile != nullptr) {
        starts.push_back(starts.back());  // The projectors' poses of the flexible profile are a further start.
        starts.back().projectors = profile->projectors;
      }
      starts.push_back(richer(first, model, spread, knot_rad));
      // Starts from a dome.
      for (const std::size_t bend : {2U, 3U, 4U}) starts.back().surface.parameters[bend] = 0.5 * round;
      break;
    case calibration::SurfaceModel::kProfile:
      starts.push_back(richer(cylinder, model, spread, knot_rad));
      // In a corner, plane and cylinder may both have converged to one of the two walls, from which no descent leads to
      // the corner.
      for (const double curvature : {round, 0.4 * round})
        starts.push_back(richer(bent(curvature), model, spread, knot_rad));
      break;
    case calibration::SurfaceModel::kMesh: {
      const calibration::SurfaceFit* best = &cylinder;
      double min = std::numeric_limits<double>::infinity();
      for (const auto& [smaller, attempt] : tried) {
        if (attempt.fit.projectors.empty() || !(attempt.trial.training_rms_px < min)) continue;
        min = attempt.trial.training_rms_px;
        best = &attempt.fit;
      }
      starts.push_back(richer(*best, model, spread, knot_rad));
      break;
    }
  }
  return starts;
}

/// Results of all lens models for one wall model.
struct LensSelectionTest {
  std::vector<Tried> tried;  ///< In the order of kProjectorLensModels.
  std::size_t best_at = 0;

  [[nodiscard]] const calibration::ModelTrial& best() const { return tried[best_at].trial; }
  [[nodiscard]] const Tried& of(calibration::LensModel model) const {
    return tried[static_cast<std::size_t>(std::ranges::find(kProjectorLensModels, model) -
                                          std::begin(kProjectorLensModels))];
  }
  [[nodiscard]] calibration::LensModel min(const ModelOptions& options) const {
    for (std::size_t i = 0; i < tried.size(); ++i) {
      const calibration::ModelTrial& trial = tried[i].trial;
      if (trial.is_usable && trial.heldout_rms_px <= best().heldout_rms_px + options.lens_tolerance_px)
        return kProjectorLensModels[i];
    }
    return kWallsLens;
  }
};

/// Fits all lens models. `wall` is the fit with kWallsLens.
LensSelectionTest climb_lenses(const ModelSelection& selection, const Tried& wall) {
  std::vector<std::future<Tried>> attempts;
  for (const calibration::LensModel model : kProjectorLensModels) {
    attempts.push_back(std::async(model == kWallsLens ? std::launch::deferred : std::launch::async, [&, model] {
      const std::string name(calibration::name_of(model));
      if (model != kWallsLens) return selection.attempt(name, calibration::freedom_of(model), {wall.fit}, model);
      Tried known = wall;
      known.trial.name = name;
      known.trial.parameters = calibration::freedom_of(model);
      return known;
    }));
  }
  LensSelectionTest lenses;
  for (auto& attempt : attempts) lenses.tried.push_back(attempt.get());
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < lenses.tried.size(); ++i) {
    const calibration::ModelTrial& trial = lenses.tried[i].trial;
    if (!trial.is_usable || trial.heldout_rms_px >= best) continue;
    best = trial.heldout_rms_px;
    lenses.best_at = i;
  }
  return lenses;
}

/// Returns the smallest wall model that predicts about as well as the best one.
std::optional<calibration::SurfaceModel> smallest_good(const std::map<calibration::SurfaceModel, Tried>& tried,
                                                       const ModelOptions& options) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [model, attempt] : tried) {
    if (attempt.trial.is_usable) best = std::min(best, attempt.trial.heldout_rms_px);
  }
  for (const auto& [model, attempt] : tried) {
    if (attempt.trial.is_usable && attempt.trial.heldout_rms_px <= options.allows(best)) return model;
  }
  return std::nullopt;
}

}  // namespace

Result<calibration::ModelChoice> choose_model(const std::vector<MeasuredProjector>& projectors,
                                              std::span<const MapSample> samples, double wall_distance_m,
                                              const ModelOptions& options) {
  CHECK(options.folds >= 2);
  TRY_ASSIGN(const calibration::SurfaceFit first, surface_start(projectors, samples, wall_distance_m));
  std::vector<Eigen::Vector3d> spread;
  double noise = 0.0;
  for (const MapSample& sample : samples) {
    spread.push_back(sample.direction);
    noise += sample.sigma_px * sample.sigma_px;
  }
  noise = std::sqrt(noise / static_cast<double>(samples.size()));
  ModelSelection selection(projectors, samples, options);
  std::map<calibration::SurfaceModel, Tried> tried;
  double best = std::numeric_limits<double>::infinity();
  for (const calibration::SurfaceModel model : calibration::kSurfaceModels) {
    const auto starts = starts_of(model, first, tried, spread, options.knot_rad);
    Tried attempt =
        selection.attempt(std::string(calibration::name_of(model)), starts.front().surface.size(), starts, kWallsLens);
    const bool is_better = attempt.trial.is_usable && options.allows(attempt.trial.heldout_rms_px) < best;
    if (attempt.trial.is_usable) best = std::min(best, attempt.trial.heldout_rms_px);
    tried[model] = std::move(attempt);
    if (!is_better && best <= kAsGoodAsNoise * noise) break;
  }
  calibration::ModelChoice choice;
  for (const auto& [model, attempt] : tried) choice.surfaces.push_back(attempt.trial);
  std::optional<calibration::SurfaceModel> chosen = smallest_good(tried, options);
  if (!chosen) {
    return Error(ErrorCode::kBadData,
                 "no wall fits what the projectors light; look whether their places and lenses in the installation are "
                 "about right");
  }
  LensSelectionTest lenses = climb_lenses(selection, tried[*chosen]);
  // If the lenses need a richer model than kWallsLens, richer walls may have compensated for it, so walls are compared
  // again with that lens model.
  if (kLensMatters * lenses.best().heldout_rms_px < lenses.of(kWallsLens).trial.heldout_rms_px) {
    const calibration::LensModel lens = kProjectorLensModels[lenses.best_at];
    std::map<calibration::SurfaceModel, Tried> again;
    for (const auto& [model, attempt] : tried) {
      if (model > *chosen || attempt.fit.projectors.empty()) continue;
      again[model] =
          selection.attempt(fmt::format("{} with lens {}", calibration::name_of(model), calibration::name_of(lens)),
                            attempt.trial.parameters, {attempt.fit}, lens);
      choice.surfaces.push_back(again[model].trial);
    }
    const auto smaller = smallest_good(again, options);
    if (smaller && *smaller != *chosen) {
      chosen = smaller;
      lenses = climb_lenses(selection, tried[*chosen]);
    }
  }
  std::string flat;
  if (*chosen == calibration::SurfaceModel::kCylinder) {
    const calibration::LensModel lens = lenses.min(options);
    TRY_ASSIGN(const calibration::SurfaceFit sure,
               fit_surface(projectors, samples, lenses.of(lens).fit, {lens, true, 50, false}));
    const double sigma = sure.surface_sigmas[3];
    if (std::abs(sure.surface.curvature_per_m()) < kFlat_sigmas * sigma &&
        tried[calibration::SurfaceModel::kPlane].trial.is_usable) {
      chosen = calibration::SurfaceModel::kPlane;
      lenses = climb_lenses(selection, tried[*chosen]);
      flat =
          fmt::format("; its curvature is below {} sigma of {:.2g} per metre, so it is a plane", kFlat_sigmas, sigma);
    }
  }
  for (const Tried& lens : lenses.tried) choice.lenses.push_back(lens.trial);
  choice.lens = lenses.min(options);
  TRY_ASSIGN(choice.fit, fit_surface(projectors, samples, lenses.of(choice.lens).fit, {choice.lens, true, 50, false}));
  choice.reason =
      fmt::format("{} with lens {}: {:.3f} px on what was left out, the best of all {:.3f} px{}",
                  calibration::name_of(*chosen), calibration::name_of(choice.lens),
                  prediction_error_px(choice.fit, samples), std::min(best, lenses.best().heldout_rms_px), flat);
  return choice;
}

}  // namespace cyclorama::solve
