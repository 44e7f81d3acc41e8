// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "appliance/healing/estimator/continuous_state.h"

namespace cyclorama {
namespace {

constexpr int kLeastCompared = 10;    // Patches, before a projector is called lost in a camera.
constexpr double kLostBelow = 0.35;   // Part of them that fits.
constexpr double kFoundAbove = 0.45;  // Part that has to fit when it is found again.
constexpr int kLeastFits = 10;
constexpr std::size_t kLeastEdges = 8;
constexpr double kNoisiest = 6.0;   // Residuals, in promised deviations.
constexpr double kSurest_px = 1.0;  // What a new place must be known to.
constexpr double kCoarseSigma_px = 3.0;
constexpr double kFeatureSigma_px = 4.0;
constexpr int kPatience = 4;      // Features are looked for at each of the first searches, then every so many.
constexpr double kCaution = 4.0;  // Variance of a new place, in what the solver promised: patches share errors.

std::vector<PoseStep> no_starts(std::size_t bodies) { return std::vector<PoseStep>(bodies, PoseStep::Zero()); }

}  // namespace

ShowCalibration moved(const ShowCalibration& room, const PoseSolution& solution, std::span<const BodyIndex> bodies) {
  ShowCalibration changed = room;
  for (const BodyIndex body : bodies) {
    const PoseStep& step = solution.bodies[body].step;
    if (body < room.projectors.size()) {
      ShowProjector& projector = changed.projectors[body];
      projector.T_room_projector = stepped(projector.T_room_projector, step);
    } else {
      ShowCamera& camera = changed.cameras[body - room.projectors.size()];
      camera.T_room_camera = stepped(camera.T_room_camera, step);
    }
  }
  return changed;
}

std::string clock_text(TimePoint begun, TimePoint now) {
  return fmt::format("{:.2f} s", std::chrono::duration<double>(now - begun).count());
}

std::vector<Sighting> ContinuousCalibrator::State::trusted_sightings() const {
  std::vector<Sighting> all;
  for (const Look& look : looks) {
    std::vector<PatchShift> patches;
    for (std::size_t i = 0; i < look.patches.size(); ++i) {
      if (areas[look.camera].is_trusted(i)) patches.push_back(look.patches[i]);
    }
    const CameraLook& camera = cameras[look.camera];
    const auto some =
        sightings_of(camera.predicted_room(), believed, look.camera, camera.factor(), patches, options.least_sigma_px);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

std::vector<EdgeSighting> ContinuousCalibrator::State::edges(std::span<const Look> of) const {
  std::vector<EdgeSighting> all;
  for (const Look& look : of) {
    std::ranges::copy_if(look.edges, std::back_inserter(all), [&](const EdgeSighting& edge) {
      return edge.part == Outline::kSide ? options.uses_sides : options.uses_arcs;
    });
  }
  return all;
}

std::vector<BodyPrior> ContinuousCalibrator::State::priors() const {
  std::vector<BodyPrior> all;
  for (const PoseFilter& filter : filters) {
    const PoseMatrix inverse = filter.root().inverse();
    all.push_back({inverse.transpose() * inverse, PoseStep::Zero()});
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
  for (const Look& look : looks) {
    const std::vector<Tally> tallies = tally(look.patches, projectors());
    for (std::size_t i = 0; i < tallies.size(); ++i) {
      if (tallies[i].compared() >= kLeastCompared && tallies[i].fits < kLostBelow * tallies[i].compared())
        pairs.emplace_back(look.camera, i);
    }
  }
  return pairs;
}

std::optional<Movers> ContinuousCalibrator::State::by_patches() const {
  auto movers = find_movers(believed, trusted_sightings(), edges(looks), priors(), no_starts(bodies()));
  if (!movers || movers->bodies.empty()) return std::nullopt;
  return *std::move(movers);
}

std::optional<Movers> ContinuousCalibrator::State::by_coarse_patches() const {
  const auto gone = lost();
  std::vector<Sighting> sightings;
  for (const Look& look : looks) {
    const CameraLook& camera = cameras[look.camera];
    const auto is_gone = [&](int projector) {
      return std::ranges::find(gone, std::pair(look.camera, static_cast<std::size_t>(projector))) != gone.end();
    };
    std::vector<PatchShift> fine = look.patches;
    std::erase_if(fine, [&](const PatchShift& p) { return p.projector < 0 || is_gone(p.projector); });
    std::vector<PatchShift> coarse = align_coarsely(look.prediction, look.seen, gains[look.camera]);
    std::erase_if(coarse, [&](const PatchShift& p) { return p.projector < 0 || !is_gone(p.projector); });
    for (const auto& [patches, sigma] :
         {std::pair(&fine, options.least_sigma_px), std::pair(&coarse, kCoarseSigma_px)}) {
      const auto some = sightings_of(camera.predicted_room(), believed, look.camera, camera.factor(), *patches, sigma);
      sightings.insert(sightings.end(), some.begin(), some.end());
    }
  }
  auto movers = find_movers(believed, sightings, edges(looks), priors(), no_starts(bodies()));
  if (!movers || movers->bodies.empty()) return std::nullopt;
  return *std::move(movers);
}

std::optional<Movers> ContinuousCalibrator::State::by_features() const {
  std::vector<Sighting> sightings;
  for (const Look& look : looks) {
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
    const CameraLook& camera = cameras[look.camera];
    const auto some =
        sightings_of(camera.predicted_room(), believed, look.camera, camera.factor(), patches, kFeatureSigma_px);
    sightings.insert(sightings.end(), some.begin(), some.end());
  }
  std::vector<PoseStep> starts = no_starts(bodies());
  for (std::size_t i = 0; i < projectors(); ++i) {
    if (const auto step = find_projector(believed, i, sightings)) starts[i] = *step;
  }
  for (const Look& look : looks) {
    if (const auto step = find_camera(believed, look.camera, sightings)) starts[projectors() + look.camera] = *step;
  }
  // The outline is only looked for nearby, so it speaks against a camera that moved far.
  auto movers = find_movers(believed, sightings, {}, priors(), starts);
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
  const bool is_due = fruitless < kPatience || fruitless % kPatience == 0;
  ++fruitless;
  if (!is_due) return false;
  const auto far = by_features();
  if (!far || !accept_some(*far, now, report)) return false;
  fruitless = 0;
  return true;
}

void ContinuousCalibrator::State::refuse(const Movers& movers) {
  for (const BodyIndex body : movers.bodies) is_refused[body] = true;
}

std::vector<bool> ContinuousCalibrator::State::anchored(std::span<const Look> of) const {
  std::vector<bool> is_held(bodies(), false);
  for (const Look& look : of) {
    const std::vector<Tally> tallies = tally(look.patches, projectors());
    const auto seen = std::ranges::count_if(tallies, [](const Tally& t) { return t.compared() >= kLeastFits; });
    if (look.edges.size() < kLeastEdges && seen < 2) continue;
    is_held[projectors() + look.camera] = true;
    for (std::size_t i = 0; i < tallies.size(); ++i) is_held[i] = is_held[i] || tallies[i].compared() >= kLeastFits;
  }
  return is_held;
}

bool ContinuousCalibrator::State::are_anchored(std::span<const BodyIndex> movers, std::span<const Look> anew) {
  const std::vector<bool> is_held = anchored(anew);
  bool are_all = true;
  for (const BodyIndex body : movers) {
    if (is_held[body]) continue;
    are_all = false;
    if (body < projectors()) is_unanchored[body] = true;
    for (const Look& look : anew) {
      if (body != projectors() + look.camera) continue;
      const std::vector<Tally> tallies = tally(look.patches, projectors());
      for (std::size_t i = 0; i < tallies.size(); ++i) {
        if (tallies[i].compared() >= kLeastFits) is_unanchored[i] = true;
      }
    }
  }
  return are_all;
}

bool ContinuousCalibrator::State::have_witness(std::span<const BodyIndex> movers, std::span<const Look> of) const {
  if (is_calm) return true;
  return std::ranges::all_of(movers, [&](BodyIndex mover) {
    // A camera that turned and one whose clock is wrong look alike while the picture turns.
    if (mover >= projectors()) return false;
    return std::ranges::any_of(of, [&](const Look& look) {
      const std::vector<Tally> tallies = tally(look.patches, projectors());
      if (tallies[mover].compared() < kLeastFits) return false;
      for (BodyIndex other = 0; other < projectors(); ++other) {
        if (std::ranges::find(movers, other) != movers.end() || surprises[other] > 0) continue;
        if (tallies[other].fits >= kLeastFits && 10 * tallies[other].fits >= 6 * tallies[other].compared()) return true;
      }
      return false;
    });
  });
}

bool ContinuousCalibrator::State::accept_some(const Movers& movers, TimePoint now, ShowReport* report) {
  if (accept(movers, now, report)) return true;
  if (movers.bodies.size() < 2) return false;
  return std::ranges::any_of(movers.bodies, [&](BodyIndex body) {
    return accept({{body}, movers.solution}, now, report);
  });
}

bool ContinuousCalibrator::State::accept(const Movers& movers, TimePoint now, ShowReport* report) {
  // A camera's tallies are its own; a projector's are summed over the cameras.
  const auto sums = [&](const std::vector<Look>& all) {
    std::vector<Tally> bodies_fit(bodies());
    for (const Look& look : all) {
      const std::vector<Tally> tallies = tally(look.patches, projectors());
      for (std::size_t i = 0; i < tallies.size(); ++i) {
        bodies_fit[i] += tallies[i];
        bodies_fit[projectors() + look.camera] += tallies[i];
      }
    }
    return bodies_fit;
  };
  ShowCalibration tried = moved(believed, movers.solution, movers.bodies);
  std::vector<BodyPrior> loosened = priors();
  for (const BodyIndex body : movers.bodies) loosened[body].information = loose_information();
  std::vector<Look> anew = looks;
  std::vector<CameraLook> eyes;
  std::optional<PoseSolution> solution;
  // Twice: the second prediction is made where the first one's patches led.
  for (int round = 0; round < 2; ++round) {
    eyes.clear();
    std::vector<Sighting> sightings;
    for (Look& look : anew) {
      CameraLook& eye = eyes.emplace_back(cameras[look.camera]);
      eye.set_room(tried);
      eye.compare(gains[look.camera], &look);
      const auto some =
          sightings_of(eye.predicted_room(), tried, look.camera, eye.factor(), look.patches, options.least_sigma_px);
      sightings.insert(sightings.end(), some.begin(), some.end());
    }
    auto solved = solve_poses(tried, sightings, edges(anew), loosened);
    if (!solved) return false;
    solution = *std::move(solved);
    tried = moved(tried, *solution, movers.bodies);
  }
  const std::vector<Tally> before = sums(looks);
  const std::vector<Tally> after = sums(anew);
  if (solution->noise > kNoisiest || !are_anchored(movers.bodies, anew)) return false;
  if (!have_witness(movers.bodies, anew)) return false;
  for (const BodyIndex body : movers.bodies) {
    const bool is_found = after[body].fits >= kLeastFits && after[body].fits >= kFoundAbove * after[body].compared() &&
                          10 * after[body].fits >= 9 * before[body].fits;
    if (!is_found || solution->bodies[body].rank < 6) return false;
    const PoseStep way = body < projectors() ? step_between(scanned.projectors[body].T_room_projector,
                                                            tried.projectors[body].T_room_projector)
                                             : step_between(scanned.cameras[body - projectors()].T_room_camera,
                                                            tried.cameras[body - projectors()].T_room_camera);
    if (!(way.head<3>().norm() < 2.0 * kMostTurn_rad && way.tail<3>().norm() < 2.0 * kMostShift_m)) return false;
    if (body < projectors() && motion[body].sigma_px(kCaution * solution->bodies[body].covariance) > kSurest_px)
      return false;
  }
  // Nobody else may fit worse for it.
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
      const PoseStep step = step_between(believed.cameras[camera].T_room_camera, tried.cameras[camera].T_room_camera);
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
    // What the scan left over stays what it was: only the change is applied.
    const PoseStep change =
        step_between(believed.projectors[body].T_room_projector, tried.projectors[body].T_room_projector);
    const auto since_settled = step_between(
        is_settled ? reference.projectors[body].T_room_projector : believed.projectors[body].T_room_projector,
        tried.projectors[body].T_room_projector);
    believed.projectors[body] = tried.projectors[body];
    applied.projectors[body].T_room_projector = stepped(scanned.projectors[body].T_room_projector, since_settled);
    motion[body] = pixel_motion(believed, believed.projectors[body]);
    measured_at[body] = now;
    const double moved_px = motion[body].rms_px(step_between(was, applied.projectors[body].T_room_projector));
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

}  // namespace cyclorama
