// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/procam_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama::camera_calibration {
namespace {

/// All lens models but the last: oblong pixels are not tried, since neither cameras nor projectors have them, and
/// boards seldom determine them.
constexpr std::size_t kModels = calibration::kLensModels.size() - 1;

void leave_each_out(const std::vector<BoardView>& views, const ProcamChoice& choice, ProcamCandidate* model) {
  double squares = 0.0;
  double prediction_squares = 0.0;
  std::vector<Eigen::Vector2d> centres;
  for (std::size_t left_out = 0; left_out < views.size(); ++left_out) {
    std::vector<BoardView> others = views;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
    const auto calibration = solve_procam(others, choice);
    const auto fold = calibration ? held_out(views[left_out], *calibration) : Result<HeldOut>(calibration.error());
    if (!fold) {
      model->heldout_rms_px = model->prediction_rms_px = model->centre_scatter_px =
          std::numeric_limits<double>::infinity();
      return;
    }
    model->folds.push_back(*fold);
    squares += fold->stereo_rms_px * fold->stereo_rms_px;
    prediction_squares += fold->projector_rms_px * fold->projector_rms_px;
    centres.emplace_back(calibration->projector.centre_u_px, calibration->projector.centre_v_px);
  }
  const auto folds = static_cast<double>(views.size());
  model->heldout_rms_px = std::sqrt(squares / folds);
  model->prediction_rms_px = std::sqrt(prediction_squares / folds);
  for (const Eigen::Vector2d& a : centres) {
    for (const Eigen::Vector2d& b : centres)
      model->centre_scatter_px = std::max(model->centre_scatter_px, (a - b).norm());
  }
}

ProcamCandidate tried(const std::vector<BoardView>& views, const ProcamChoice& choice) {
  ProcamCandidate model;
  model.camera = choice.camera_model;
  model.projector = choice.projector_model;
  model.board = choice.board_model;
  model.freedom = calibration::freedom_of(model.camera) + calibration::freedom_of(model.projector) +
                  (model.board == BoardModel::kBent ? kBoardValues : 0);
  const auto all = solve_procam(views, choice);
  model.training_rms_px = all ? all->stereo_rms_px : std::numeric_limits<double>::infinity();
  if (all) {
    leave_each_out(views, choice, &model);
  } else {
    model.heldout_rms_px = model.prediction_rms_px = std::numeric_limits<double>::infinity();
  }
  return model;
}

/// Returns the models with one richer lens.
std::vector<ProcamChoice> above(const ProcamChoice& choice) {
  std::vector<ProcamChoice> choices;
  for (calibration::LensModel ProcamChoice::*lens : {&ProcamChoice::camera_model, &ProcamChoice::projector_model}) {
    const auto first = static_cast<std::size_t>(choice.*lens) + 1;
    for (std::size_t i = first; i < std::min(first + 2, kModels); ++i) {
      choices.push_back(choice);
      choices.back().*lens = calibration::kLensModels.at(i);
    }
  }
  return choices;
}

/// Tries `standing` and richer models, as long as a step improves the prediction by kMinModelGain.
void climb(const std::vector<BoardView>& views, ProcamChoice standing, std::vector<ProcamCandidate>* models) {
  models->push_back(tried(views, standing));
  double here = models->back().heldout_rms_px;
  for (bool climbs = true; climbs;) {
    climbs = false;
    double best = here * (1.0 - calibration::kMinModelGain);
    ProcamChoice better = standing;
    for (const ProcamChoice& choice : above(standing)) {
      models->push_back(tried(views, choice));
      if (!(models->back().heldout_rms_px < best)) continue;
      best = here = models->back().heldout_rms_px;
      better = choice;
      climbs = true;
    }
    standing = better;
  }
}

}  // namespace

Result<ProcamSelection> select_procam_model(const std::vector<BoardView>& views, ImageSize camera,
                                            ImageSize projector) {
  if (views.size() < 3) {
    return Error(ErrorCode::kBadData,
                 "a model is chosen by views that are left out: photograph the board in three poses or more");
  }
  ProcamChoice min{camera, projector, calibration::LensModel::kPinhole, calibration::LensModel::kPinhole};
  min.starts = 1;
  // The validity of views does not depend on the model, so it is tested with the smallest model.
  const auto any = solve_procam(views, min);
  if (!any && any.error().code() == ErrorCode::kInvalidArgument) return any.error();
  ProcamSelection selection;
  for (const BoardModel board : {BoardModel::kFlat, BoardModel::kBent}) {
    min.board_model = board;
    climb(views, min, &selection.models);
  }
  double best = std::numeric_limits<double>::infinity();
  for (const ProcamCandidate& model : selection.models) best = std::min(best, model.heldout_rms_px);
  if (!std::isfinite(best)) {
    return Error(ErrorCode::kBadData,
                 "no lens model is determined when a view is left out: photograph the board in more poses, turned "
                 "by 20 degrees or more about different axes");
  }
  const ProcamCandidate* chosen = nullptr;
  for (const ProcamCandidate& model : selection.models) {
    if (!(model.heldout_rms_px * (1.0 - calibration::kMinModelGain) <= best)) continue;
    if (chosen == nullptr || model.freedom < chosen->freedom ||
        (model.freedom == chosen->freedom && model.heldout_rms_px < chosen->heldout_rms_px)) {
      chosen = &model;
    }
  }
  selection.chosen = static_cast<std::size_t>(chosen - selection.models.data());
  TRY_ASSIGN(selection.calibration,
             solve_procam(views, {camera, projector, chosen->camera, chosen->projector, chosen->board}));
  return selection;
}

}  // namespace cyclorama::camera_calibration
