// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "appliance/healing/estimator/continuous_state.h"

namespace cyclorama::healing {
namespace {

// Minimum number of compared patches for a projector to count as lost in a camera's picture.
constexpr int kMinComparedPatches = 10;
constexpr double kLostBelow = 0.35;   // A projector is lost if a smaller share of its patches fits.
constexpr double kFoundAbove = 0.45;  // Minimum share of fitting patches at an accepted pose.
constexpr int kMinFits = 10;
constexpr std::size_t kMinEdges = 8;
constexpr double kNoisiest = 6.0;   // Maximum noise of the residuals, relative to the expected noise.
constexpr double kSurest_px = 1.0;  // Maximum standard deviation of a new pose.
constexpr double kCoarseSigma_px = 3.0;
constexpr double kFeatureSigma_px = 4.0;
constexpr int kFeatureSearchEvery = 4;  // Features are matched in the first four attempts, then in every fourth.
constexpr double kCaution = 4.0;        // Factor on the solver's variance of a new pose, since patches share errors.

std::vector<calibration::PoseStep> no_starts(std::size_t bodies) {
  return std::vector<calibration::PoseStep>(bodies, calibration::PoseStep::Zero());
}

}  // namespace

calibration::ShowCalibration moved(const calibration::ShowCalibration& room, const PoseSolution& solution,
                                   std::span<const BodyIndex> bodies) {
  calibration::ShowCalibration changed = room;
  for (const BodyIndex body : bodies) {
    const calibration::PoseStep& step = solution.bodies[body].step;
    if (body < room.projectors.size()) {
      calibration::ShowProjector& projector = changed.projectors[body];
      projector.T_room_projector = calibration::stepped(projector.T_room_projector, step);
    } else {
      calibration::ShowCamera& camera = changed.cameras[body - room.projectors.size()];
      camera.T_room_camera = calibration::stepped(camera.T_room_camera, step);
    }
  }
  return changed;
}

std::string clock_text(TimePoint begun, TimePoint now) {
  return fmt::format("{:.2f} s", std::chrono::duration<double>(now - begun).count());
}

std::vector<PatchObservation> ContinuousCalibrator::State::trusted_observations() const {
  std::vector<PatchObservation> all;
  for (const CameraObservation& look : looks) {
    std::vector<PatchShift> patches;
    for (std::size_t i = 0; i < look.patches.size(); ++i) {
      if (areas[look.camera].is_trusted(i)) patches.push_back(look.patches[i]);
    }
    const CameraMonitor& camera = cameras[look.camera];
    const auto some = patch_observations(camera.predicted_room(), believed, look.camera, camera.factor(), patches,
                                         options.min_sigma_px);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

std::vector<EdgeObservation> ContinuousCalibrator::State::edges(std::span<const CameraObservation> of) const {
  std::vector<EdgeObservation> all;
  for (const CameraObservation& look : of) {
    std::ranges::copy_if(look.edges, std::back_inserter(all), [&](const EdgeObservation& edge) {
      return edge.part == Outline::kSide ? options.uses_sides : options.uses_arcs;
    });
  }
  return all;
}

std::vector<BodyPrior> ContinuousCalibrator::State::priors() const {
  std::vector<BodyPrior> all;
  for (const PoseFilter& filter : filters) {
    const calibration::PoseMatrix inverse = filter.root().inverse();
    all.push_back({inverse.transpose() * inverse, calibration::PoseStep::Zero()});
  }
  return all;
}

std::vector<BodyPrior> ContinuousCalibrator::State::loose_projectors() const {
  std::vector<BodyPrior> all = priors();
  for (std::size_t i = 0; i < projectors(); ++i) all[i].information = loose_information();
  return all;
}

std::vector<std::pair<std::size_t, std::size_t>> ContinuousCalibrator::State::lost() const {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const CameraObservation& look : looks) {
    const std::vector<PatchTally> tallies = tally(look.patches, projectors());
    for (std::size_t i = 0; i < tallies.size(); ++i) {
      if (tallies[i].compared() >= kMinComparedPatches && tallies[i].fits < kLostBelow * tallies[i].compared())
        pairs.emplace_back(look.camera, i);
    }
  }
  return pairs;
}

std::optional<MovedBodies> ContinuousCalibrator::State::by_patches() const {
  auto movers = find_moved_bodies(believed, trusted_observations(), edges(looks), priors(), no_starts(bodies()));
  if (!movers || movers->bodies.empty()) return std::nullopt;
  return *std::move(movers);
}

std::optional<MovedBodies> ContinuousCalibrator::State::by_coarse_patches() const {
  const auto gone = lost();
  std::vector<PatchObservation> observations;
  for (const CameraObservation& look : looks) {
    const CameraMonitor& camera = cameras[look.camera];
    const auto is_gone = [&](int projector) {
      return std::ranges::find(gone, std::pair(look.camera, static_cast<std::size_t>(projector))) != gone.end();
    };
    std::vector<PatchShift> fine = look.patches;
    std::erase_if(fine, [&](const PatchShift& p) { return p.projector < 0 || is_gone(p.projector); });
    std::vector<PatchShift> coarse = align_coarsely(look.prediction, look.seen, gains[look.camera]);
    std::erase_if(coarse, [&](const PatchShift& p) { return p.projector < 0 || !is_gone(p.projector); });
    for (const auto& [patches, sigma] : {std::pair(&fine, options.min_sigma_px), std::pair(&coarse, kCoarseSigma_px)}) {
      const auto some =
          patch_observations(camera.predicted_room(), believed, look.camera, camera.factor(), *patches, sigma);
      observations.insert(observations.end(), some.begin(), some.end());
    }
  }
  auto movers = find_moved_bodies(believed, observations, edges(looks), priors(), no_starts(bodies()));
  if (!movers || movers->bodies.empty()) return std::nullopt;
  return *std::move(movers);
}

std::optional<MovedBodies> ContinuousCalibrator::State::by_features() const {
  std::vector<PatchObservation> observations;
  for (const CameraObservation& look : looks) {
    const auto found = match_features(look.prediction, look.seen, FeatureKind::kSift);
    if (!found) continue;
    std::vector<PatchShift> patches;
    for (const FeatureMatch& match : found->matches) {
      PatchShift patch;
      patch.at = match.predicted;
      patch.shift = match.seen - match.predicted;
      patch.projector = match.projector;
      patch.fit = PatchFit::kFits;
      patches.push_back(patch);
    }
    const CameraMonitor& camera = cameras[look.camera];
    const auto some =
        patch_observations(camera.predicted_room(), believed, look.camera, camera.factor(), patches, kFeatureSigma_px);
    observations.insert(observations.end(), some.begin(), some.end());
  }
  std::vector<calibration::PoseStep> starts = no_starts(bodies());
  for (std::size_t i = 0; i < projectors(); ++i) {
    if (const auto step = find_projector(believed, i, observations)) starts[i] = *step;
  }
  for (const CameraObservation& look : looks) {
    if (const auto step = find_camera(believed, look.camera, observations)) starts[projectors() + look.camera] = *step;
  }
  // The outline is searched only near its expected position, so it would count against a camera that moved far.
  auto movers = find_moved_bodies(believed, observations, {}, priors(), starts);
  if (!movers || movers->bodies.empty()) return std::nullopt;
  return *std::move(movers);
}

bool ContinuousCalibrator::State::recover(TimePoint now, bool is_lost, ShowReport* report) {
  if (!is_lost) {
    const auto movers = by_patches();
    if (!movers) return false;
    if (accept_some(*movers, now, report)) return true;
    refuse(*movers);
    return false;
  }
  const auto near = by_coarse_patches();
  if (near && accept_some(*near, now, report)) {
    fruitless = 0;
    return true;
  }
  const bool is_due = fruitless < kFeatureSearchEvery || fruitless % kFeatureSearchEvery == 0;
  ++fruitless;
  if (!is_due) return false;
  const auto far = by_features();
  if (!far || !accept_some(*far, now, report)) return false;
  fruitless = 0;
  return true;
}

void ContinuousCalibrator::State::refuse(const MovedBodies& movers) {
  for (const BodyIndex body : movers.bodies) is_refused[body] = true;
}

std::vector<bool> ContinuousCalibrator::State::anchored(std::span<const CameraObservation> of) const {
  std::vector<bool> is_held(bodies(), false);
  for (const CameraObservation& look : of) {
    const std::vector<PatchTally> tallies = tally(look.patches, projectors());
    const auto seen = std::ranges::count_if(tallies, [](const PatchTally& t) { return t.compared() >= kMinFits; });
    if (look.edges.size() < kMinEdges && seen < 2) continue;
    is_held[projectors() + look.camera] = true;
    for (std::size_t i = 0; i < tallies.size(); ++i) is_held[i] = is_held[i] || tallies[i].compared() >= kMinFits;
  }
  return is_held;
}

bool ContinuousCalibrator::State::are_anchored(std::span<const BodyIndex> movers,
                                               std::span<const CameraObservation> anew) {
  const std::vector<bool> is_held = anchored(anew);
  bool are_all = true;
  for (const BodyIndex body : movers) {
    if (is_held[body]) continue;
    are_all = false;
    if (body < projectors()) is_unanchored[body] = true;
    for (const CameraObservation& look : anew) {
      if (body != projectors() + look.camera) continue;
      const std::vector<PatchTally> tallies = tally(look.patches, projectors());
      for (std::size_t i = 0; i < tallies.size(); ++i) {
        if (tallies[i].compared() >= kMinFits) is_unanchored[i] = true;
      }
    }
  }
  return are_all;
}

bool ContinuousCalibrator::State::have_reference(std::span<const BodyIndex> movers,
                                                 std::span<const CameraObservation> of) const {
  if (is_calm) return true;
  return std::ranges::all_of(movers, [&](BodyIndex mover) {
    // While the content moves, a turned camera and a camera with a wrong clock look alike.
    if (mover >= projectors()) return false;
    return std::ranges::any_of(of, [&](const CameraObservation& look) {
      const std::vector<PatchTally> tallies = tally(look.patches, projectors());
      if (tallies[mover].compared() < kMinFits) return false;
      for (BodyIndex other = 0; other < projectors(); ++other) {
        if (std::ranges::find(movers, other) != movers.end() || surprises[other] > 0) continue;
        if (tallies[other].fits >= kMinFits && 10 * tallies[other].fits >= 6 * tallies[other].compared()) return true;
      }
      return false;
    });
  });
}

bool ContinuousCalibrator::State::accept_some(const MovedBodies& movers, TimePoint now, ShowReport* report) {
  if (accept(movers, now, report)) return true;
  if (movers.bodies.size() < 2) return false;
  return std::ranges::any_of(movers.bodies, [&](BodyIndex body) {
    return accept({{body}, movers.solution}, now, report);
  });
}

bool ContinuousCalibrator::State::accept(const MovedBodies& movers, TimePoint now, ShowReport* report) {
  // Sums the tallies of each body: over the cameras for a projector, over the projectors for a camera.
  const auto sums = [&](const std::vector<CameraObservation>& all) {
    std::vector<PatchTally> bodies_fit(bodies());
    for (const CameraObservation& look : all) {
      const std::vector<PatchTally> tallies = tally(look.patches, projectors());
      for (std::size_t i = 0; i < tallies.size(); ++i) {
        bodies_fit[i] += tallies[i];
        bodies_fit[projectors() + look.camera] += tallies[i];
      }
    }
    return bodies_fit;
  };
  calibration::ShowCalibration tried = moved(believed, movers.solution, movers.bodies);
  std::vector<BodyPrior> loosened = priors();
  for (const BodyIndex body : movers.bodies) loosened[body].information = loose_information();
  std::vector<CameraObservation> anew = looks;
  std::vector<CameraMonitor> eyes;
  std::optional<PoseSolution> solution;
  // The second prediction is made at the pose that the first one's patches gave.
  for (int round = 0; round < 2; ++round) {
    eyes.clear();
    std::vector<PatchObservation> observations;
    for (CameraObservation& look : anew) {
      CameraMonitor& eye = eyes.emplace_back(cameras[look.camera]);
      eye.set_room(tried);
      eye.compare(gains[look.camera], &look);
      const auto some = patch_observations(eye.predicted_room(), tried, look.camera, eye.factor(), look.patches,
                                           options.min_sigma_px);
      observations.insert(observations.end(), some.begin(), some.end());
    }
    auto solved = solve_poses(tried, observations, edges(anew), loosened);
    if (!solved) return false;
    solution = *std::move(solved);
    tried = moved(tried, *solution, movers.bodies);
  }
  const std::vector<PatchTally> before = sums(looks);
  const std::vector<PatchTally> after = sums(anew);
  if (solution->noise > kNoisiest || !are_anchored(movers.bodies, anew)) return false;
  if (!have_reference(movers.bodies, anew)) return false;
  for (const BodyIndex body : movers.bodies) {
    const bool is_found = after[body].fits >= kMinFits && after[body].fits >= kFoundAbove * after[body].compared() &&
                          10 * after[body].fits >= 9 * before[body].fits;
    if (!is_found || solution->bodies[body].rank < 6) return false;
    const calibration::PoseStep way =
        body < projectors() ? calibration::step_between(scanned.projectors[body].T_room_projector,
                                                        tried.projectors[body].T_room_projector)
                            : calibration::step_between(scanned.cameras[body - projectors()].T_room_camera,
                                                        tried.cameras[body - projectors()].T_room_camera);
    if (!(way.head<3>().norm() < 2.0 * calibration::kMaxTurn_rad &&
          way.tail<3>().norm() < 2.0 * calibration::kMaxShift_m))
      return false;
    if (body < projectors() && motion[body].sigma_px(kCaution * solution->bodies[body].covariance) > kSurest_px)
      return false;
  }
  // No body may lose more than a fifth of its fitting patches.
  for (BodyIndex body = 0; body < bodies(); ++body) {
    if (10 * after[body].fits < 8 * before[body].fits) return false;
  }
  for (const BodyIndex body : movers.bodies) {
    filters[body].restart(kCaution * solution->bodies[body].covariance);
    surprises[body] = 0;
    is_refused[body] = false;
    if (body < projectors()) lately[body].forget();
    if (body >= projectors()) {
      const std::size_t camera = body - projectors();
      const calibration::PoseStep step =
          calibration::step_between(believed.cameras[camera].T_room_camera, tried.cameras[camera].T_room_camera);
      believed.cameras[camera] = tried.cameras[camera];
      report->log.push_back(fmt::format(
          "{}: camera '{}' moved: turned {:.3f} deg, shifted {:.1f} mm; no picture changes", clock_text(*begun_at, now),
          believed.cameras[camera].name, step.head<3>().norm() * 57.29578, step.tail<3>().norm() * 1e3));
      continue;
    }
    notice(body, report);
    is_noticed[body] = false;
    is_unanchored[body] = false;
    const auto was = applied.projectors[body].T_room_projector;
    // The scan's residuals stay unchanged: only the displacement is applied.
    const calibration::PoseStep change =
        calibration::step_between(believed.projectors[body].T_room_projector, tried.projectors[body].T_room_projector);
    const auto since_settled = calibration::step_between(
        is_settled ? reference.projectors[body].T_room_projector : believed.projectors[body].T_room_projector,
        tried.projectors[body].T_room_projector);
    believed.projectors[body] = tried.projectors[body];
    applied.projectors[body].T_room_projector =
        calibration::stepped(scanned.projectors[body].T_room_projector, since_settled);
    motion[body] = pixel_motion(believed, believed.projectors[body]);
    measured_at[body] = now;
    const double moved_px =
        motion[body].rms_px(calibration::step_between(was, applied.projectors[body].T_room_projector));
    const double sigma_px = motion[body].sigma_px(filters[body].covariance());
    report->corrections.push_back({body, was, applied.projectors[body].T_room_projector, moved_px, sigma_px, true});
    report->log.push_back(
        fmt::format("{}: projector '{}' was bumped: turned {:.3f} deg, shifted {:.1f} mm; corrected by {:.2f} px, sure "
                    "to {:.2f} px, "
                    "{} of {} patches fit, {} did before",
                    clock_text(*begun_at, now), believed.projectors[body].name, change.head<3>().norm() * 57.29578,
                    change.tail<3>().norm() * 1e3, moved_px, sigma_px, after[body].fits, after[body].compared(),
                    before[body].fits));
  }
  looks = std::move(anew);
  for (std::size_t i = 0; i < looks.size(); ++i) cameras[looks[i].camera] = std::move(eyes[i]);
  for (AreaMap& map : areas) map.restart();
  return true;
}

}  // namespace cyclorama::healing
