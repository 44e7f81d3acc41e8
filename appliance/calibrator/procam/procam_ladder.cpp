// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/procam/procam_ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama {
namespace {

/// Oblong pixels are no rung here: neither cameras nor projectors have them, and boards alone seldom tell.
constexpr std::size_t kRungs = kLensRungs.size() - 1;

void leave_each_out(const std::vector<BoardView>& views, const ProcamChoice& choice, LadderRung* rung) {
  double squares = 0.0;
  double prediction_squares = 0.0;
  std::vector<Eigen::Vector2d> centres;
  for (std::size_t left_out = 0; left_out < views.size(); ++left_out) {
    std::vector<BoardView> others = views;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
    const auto calibration = solve_procam(others, choice);
    const auto fold = calibration ? held_out(views[left_out], *calibration) : Result<HeldOut>(calibration.error());
    if (!fold) {
      rung->heldout_rms_px = rung->prediction_rms_px = rung->centre_scatter_px =
          std::numeric_limits<double>::infinity();
      return;
    }
    rung->folds.push_back(*fold);
    squares += fold->stereo_rms_px * fold->stereo_rms_px;
    prediction_squares += fold->projector_rms_px * fold->projector_rms_px;
    centres.emplace_back(calibration->projector.centre_u_px, calibration->projector.centre_v_px);
  }
  const auto folds = static_cast<double>(views.size());
  rung->heldout_rms_px = std::sqrt(squares / folds);
  rung->prediction_rms_px = std::sqrt(prediction_squares / folds);
  for (const Eigen::Vector2d& a : centres) {
    for (const Eigen::Vector2d& b : centres)
      rung->centre_scatter_px = std::max(rung->centre_scatter_px, (a - b).norm());
  }
}

}  // namespace

Result<ProcamLadder> climb_procam(const std::vector<BoardView>& views, PictureSize camera, PictureSize projector) {
  if (views.size() < 3) {
    return Error(ErrorCode::kBadData,
                 "a model is chosen by views that are left out: photograph the board in three poses or more");
  }
  ProcamLadder ladder;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < kRungs; ++c) {
    for (std::size_t p = 0; p < kRungs; ++p) {
      LadderRung rung{.camera = kLensRungs.at(c), .projector = kLensRungs.at(p)};
      rung.freedom = freedom_of(rung.camera) + freedom_of(rung.projector);
      const ProcamChoice choice{camera, projector, rung.camera, rung.projector};
      const auto all = solve_procam(views, choice);
      // What is wrong with the views themselves is wrong on every rung.
      if (!all && all.error().code() == ErrorCode::kInvalidArgument) return all.error();
      rung.training_rms_px = all ? all->stereo_rms_px : std::numeric_limits<double>::infinity();
      leave_each_out(views, choice, &rung);
      if (all) best = std::min(best, rung.heldout_rms_px);
      ladder.rungs.push_back(std::move(rung));
    }
  }
  if (!std::isfinite(best)) {
    return Error(ErrorCode::kBadData,
                 "no lens model is determined when a view is left out: photograph the board in more poses, turned "
                 "by 20 degrees or more about different axes");
  }
  const LadderRung* chosen = nullptr;
  for (const LadderRung& rung : ladder.rungs) {
    if (!(rung.heldout_rms_px <= best * (1.0 + kWorthARung)) || !std::isfinite(rung.training_rms_px)) continue;
    if (chosen == nullptr || rung.freedom < chosen->freedom ||
        (rung.freedom == chosen->freedom && rung.heldout_rms_px < chosen->heldout_rms_px)) {
      chosen = &rung;
    }
  }
  ladder.chosen = static_cast<std::size_t>(chosen - ladder.rungs.data());
  TRY_ASSIGN(ladder.calibration, solve_procam(views, {camera, projector, chosen->camera, chosen->projector}));
  return ladder;
}

}  // namespace cyclorama
