// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/continuous_calibrator.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "appliance/healing/estimator/continuous_state.h"
#include "common/base/check.h"

namespace cyclorama::healing {
namespace {

constexpr double kProjectorTurn_rad = 3e-4;  // Initial standard deviations: residuals of a scan.
constexpr double kProjectorShift_m = 1e-3;
constexpr double kCameraTurn_rad = 5e-4;
constexpr double kCameraShift_m = 2e-3;
constexpr double kCaution = 4.0;  // Factor on the solver's variance of a measurement, since patches share errors.
constexpr int kMinLearnedSteps = 5;
constexpr Duration kSettlesWithin = std::chrono::minutes(2);
constexpr int kSurprisesAreABump = 2;
// Number of surprises without an explanation after which the filter's covariance counts as too small.
constexpr int kStubborn = 6;
constexpr double kMaxFollowed_px = 1.0;
constexpr int kMinPatches = 12;
constexpr int kSearchesSeveralTimes = 8;
constexpr double kDarkest = 0.004;  // Minimum predicted mean light, as a share of the camera's full scale.
constexpr Duration kLearnsStillWithin = std::chrono::seconds(30);
constexpr Duration kRealignsFor = std::chrono::seconds(10);
constexpr double kRealignsFrom_px = 0.05;

}  // namespace

std::string_view name_of(HoldReason hold) {
  switch (hold) {
    case HoldReason::kNone:
      return "good";
    case HoldReason::kSettling:
      return "settling";
    case HoldReason::kNoPicture:
      return "no picture";
    case HoldReason::kDark:
      return "dark";
    case HoldReason::kPlain:
      return "plain";
    case HoldReason::kFast:
      return "fast";
    case HoldReason::kBlown:
      return "too bright";
    case HoldReason::kInTheWay:
      return "in the way";
    case HoldReason::kNoLight:
      return "no light";
    case HoldReason::kSearching:
      return "searching";
    case HoldReason::kUnplaced:
      return "not placed";
  }
  CHECK(false);
}

ContinuousCalibrator::State::State(const calibration::ShowCalibration& calibration, const ContinuousOptions& wanted)
    : options(wanted),
      scanned(calibration),
      believed(calibration),
      applied(calibration),
      reference(calibration),
      health(calibration.projectors.size()),
      measured_at(calibration.projectors.size()),
      surprises(calibration.projectors.size() + calibration.cameras.size(), 0),
      lately(calibration.projectors.size()),
      is_creeping(calibration.projectors.size(), false),
      is_refused(calibration.projectors.size() + calibration.cameras.size(), false),
      seems_off_px(calibration.projectors.size(), 0.0),
      is_unanchored(calibration.projectors.size(), false),
      is_noticed(calibration.projectors.size(), false),
      areas(calibration.cameras.size()),
      gains(calibration.cameras.size(), 0.0),
      times_off(calibration.cameras.size(), Duration::zero()) {
  int head_factor = 8;
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i) {
    cameras.emplace_back(calibration, i, options.width_px, options.patches);
    head_factor = std::min(head_factor, cameras.back().head_factor(calibration));
  }
  for (const calibration::ShowProjector& projector : calibration.projectors) {
    timelines.emplace_back(projector, head_factor);
    filters.emplace_back(kProjectorTurn_rad, kProjectorShift_m, options.walk);
    motion.push_back(pixel_motion(calibration, projector));
  }
  for (std::size_t i = 0; i < calibration.cameras.size(); ++i)
    filters.emplace_back(kCameraTurn_rad, kCameraShift_m, options.walk);
}

void ContinuousCalibrator::State::hold(std::size_t projector, HoldReason why, std::string reason, TimePoint now,
                                       ShowReport* report) {
  ProjectorHealth& one = health[projector];
  if (one.hold != why || (why == HoldReason::kSearching && one.reason != reason)) {
    report->log.push_back(why == HoldReason::kNone
                              ? fmt::format("{}: projector '{}' is measured again", clock_text(*begun_at, now),
                                            believed.projectors[projector].name)
                              : fmt::format("{}: projector '{}' is left as it is: {}", clock_text(*begun_at, now),
                                            believed.projectors[projector].name, reason));
  }
  one.hold = why;
  one.reason = std::move(reason);
}

void ContinuousCalibrator::State::notice(std::size_t projector, ShowReport* report) {
  if (is_noticed[projector]) return;
  is_noticed[projector] = true;
  report->noticed.push_back(projector);
}

void ContinuousCalibrator::State::learn(TimePoint now, const PoseSolution& solution, ShowReport* report) {
  const std::vector<BodyPrior> known = loose_projectors();
  std::vector<std::optional<PoseFilter::Measured>> told(bodies());
  is_creeping.assign(projectors(), false);
  bool has_camera_moved = false;
  for (BodyIndex body = 0; body < bodies(); ++body) {
    const BodySolution& one = solution.bodies[body];
    if (one.rank == 0) continue;
    PoseFilter::Measured measured = without_prior(one.step, one.information, known[body].information);
    measured.information /= kCaution * solution.noise * solution.noise;
    const PoseFilter::Innovation innovation = filters[body].innovation(measured);
    const bool is_surprise = innovation.squared > innovation_limit(innovation.directions);
    surprises[body] = is_surprise ? surprises[body] + 1 : 0;
    if (body < projectors()) {
      lately[body].add(innovation);
      seems_off_px[body] = motion[body].rms_px(one.step);
      // Drift below the correction threshold may be followed.
      is_creeping[body] =
          lately[body].is_surprising() && seems_off_px[body] >= options.correct_from_px / options.pixels;
    }
    has_camera_moved = has_camera_moved || (is_surprise && body >= projectors());
    const bool is_usual = !is_surprise && (body >= projectors() || !is_creeping[body]);
    is_refused[body] = is_refused[body] && !is_usual;
    if (is_surprise && body < projectors() && is_settled) notice(body, report);
    if (!is_surprise && !is_refused[body]) told[body] = measured;
  }
  // The projectors' measured poses depend on the cameras' poses.
  if (has_camera_moved) return;
  // A small error of the time stamp displaces moving content; drift can wait until it stands still.
  if (is_moving && still_at && now < *still_at + kLearnsStillWithin) return;
  ++learned;
  const std::vector<bool> is_anchored = anchored(looks);
  for (BodyIndex body = 0; body < bodies(); ++body) {
    // Until the calibrator has settled, bodies that are not anchored are updated too, since no correction follows.
    if (!told[body] || (is_settled && !is_anchored[body])) continue;
    const calibration::PoseStep step = filters[body].update(*told[body]);
    if (body < projectors()) {
      is_noticed[body] = false;
      is_unanchored[body] = false;
      measured_at[body] = now;
      believed.projectors[body].T_room_projector =
          calibration::stepped(believed.projectors[body].T_room_projector, step);
    } else {
      calibration::ShowCamera& camera = believed.cameras[body - projectors()];
      camera.T_room_camera = calibration::stepped(camera.T_room_camera, step);
    }
  }
}

void ContinuousCalibrator::State::loosen_stubborn() {
  const auto gone = lost();
  for (BodyIndex i = 0; i < bodies(); ++i) {
    if (surprises[i] < kStubborn || is_refused[i]) continue;
    // A displacement that was not found, or is large, is no drift.
    if (i < projectors() && (seems_off_px[i] > kMaxFollowed_px / options.pixels ||
                             std::ranges::any_of(gone, [&](const auto& pair) { return pair.second == i; }))) {
      continue;
    }
    loosen(i);
  }
}

void ContinuousCalibrator::State::loosen(BodyIndex body) {
  const bool is_camera = body >= projectors();
  calibration::PoseStep sigma;
  sigma << Eigen::Vector3d::Constant(is_camera ? kCameraTurn_rad : kProjectorTurn_rad),
      Eigen::Vector3d::Constant(is_camera ? kCameraShift_m : kProjectorShift_m);
  filters[body].restart(calibration::PoseMatrix(sigma.cwiseAbs2().asDiagonal()));
  surprises[body] = 0;
}

void ContinuousCalibrator::State::settle(TimePoint now) {
  if (is_settled || now < *begun_at + options.settle) return;
  // Settling depends on the learned steps, not on the clock alone: a step may take from a quarter of a second to two
  // seconds.
  if (learned < kMinLearnedSteps && now < *begun_at + kSettlesWithin) return;
  is_settled = true;
  // The steps learned so far are the scan's residuals, not a displacement.
  for (std::size_t i = 0; i < projectors(); ++i) {
    const calibration::PoseStep change =
        calibration::step_between(scanned.projectors[i].T_room_projector, applied.projectors[i].T_room_projector);
    reference.projectors[i].T_room_projector =
        calibration::stepped(believed.projectors[i].T_room_projector, calibration::PoseStep(-change));
  }
}

void ContinuousCalibrator::State::correct_drift(TimePoint now, ShowReport* report) {
  for (std::size_t i = 0; i < projectors(); ++i) {
    ProjectorHealth& one = health[i];
    one.sigma_px = motion[i].sigma_px(filters[i].covariance());
    one.wants_scan = now - measured_at[i] > options.scan_wanted_after || !believed.projectors[i].unplaced.empty();
    if (!is_settled) continue;
    const calibration::PoseStep change =
        calibration::step_between(reference.projectors[i].T_room_projector, believed.projectors[i].T_room_projector);
    const auto wanted = calibration::stepped(scanned.projectors[i].T_room_projector, change);
    const auto was = applied.projectors[i].T_room_projector;
    const calibration::PoseStep way = calibration::step_between(was, wanted);
    one.off_px = motion[i].rms_px(way);
    if (one.hold != HoldReason::kNone || std::ranges::any_of(surprises, [](int n) { return n > 0; })) continue;
    const bool is_wanted = realigns_until && now < *realigns_until;
    if (one.off_px < (is_wanted ? kRealignsFrom_px : options.correct_from_px) / options.pixels) continue;
    if (filters[i].squared_deviations(way) < innovation_limit(6, options.correct_from_sigmas)) continue;
    applied.projectors[i].T_room_projector = wanted;
    report->corrections.push_back({i, was, wanted, one.off_px, one.sigma_px, false});
    report->log.push_back(fmt::format("{}: projector '{}' drifted: corrected by {:.2f} px, sure to {:.2f} px",
                                      clock_text(*begun_at, now), believed.projectors[i].name, one.off_px,
                                      one.sigma_px));
    one.off_px = 0.0;
  }
}

void ContinuousCalibrator::State::tell(TimePoint now, ShowReport* report) {
  std::vector<PatchTally> sums(projectors());
  double light = 0.0;
  double pixels = 0.0;
  for (const CameraObservation& look : looks) {
    const std::vector<PatchTally> tallies = tally(look.patches, projectors());
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += tallies[i];
    for (std::size_t k = 0; k < look.prediction.owner.data().size(); k += 7) {
      if (look.prediction.owner.data()[k] == kBesideWall) continue;
      light += gains[look.camera] * static_cast<double>(look.prediction.light.light.data()[k]);
      pixels += 1.0;
    }
  }
  std::optional<std::size_t> blind;
  for (std::size_t i = 0; i < believed.cameras.size(); ++i) {
    if (is_refused[projectors() + i] && surprises[projectors() + i] >= kStubborn) blind = i;
  }
  const std::vector<bool> is_anchored = anchored(looks);
  const auto is_quiet = [&](std::size_t i) { return surprises[i] == 0 && !is_refused[i]; };
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const PatchTally& sum = sums[i];
    if (!believed.projectors[i].unplaced.empty()) {
      hold(i, HoldReason::kUnplaced, believed.projectors[i].unplaced, now, report);
    } else if (sum.compared() < kMinPatches) {
      const bool is_dark = pixels == 0.0 || light / pixels < kDarkest;
      hold(i, is_dark ? HoldReason::kDark : HoldReason::kPlain,
           is_dark ? "the show is dark" : "there is nothing in its picture to go by", now, report);
    } else if (blind) {
      hold(i, HoldReason::kSearching,
           fmt::format("camera '{}' seems to have moved, and nothing explains yet where to; no drift is corrected",
                       believed.cameras[*blind].name),
           now, report);
    } else if (10 * sum.fits >= 6 * sum.compared() && is_quiet(i) && is_settled && !is_anchored[i]) {
      hold(i, HoldReason::kPlain,
           "the camera that sees it sees nothing else; let it see a neighbour's picture or the wall's edge", now,
           report);
    } else if (10 * sum.fits >= 6 * sum.compared() && is_quiet(i)) {
      hold(i, is_settled ? HoldReason::kNone : HoldReason::kSettling, is_settled ? "" : "it has only begun", now,
           report);
    } else if (2 * sum.faint > sum.compared()) {
      notice(i, report);
      hold(i, HoldReason::kNoLight, "its part of the wall is dark; is its lamp off, or its shutter closed?", now,
           report);
    } else if (is_unanchored[i]) {
      notice(i, report);
      hold(i, HoldReason::kSearching,
           fmt::format(
               "it moved, or the camera that sees nothing else did; let that camera see a neighbour's picture or "
               "the wall's edge, and calibrate it with 'cyclorama calibrate --quick {}'",
               believed.projectors[i].name),
           now, report);
    } else if (sum.fits >= 3 * kMinPatches / 4 && is_quiet(i)) {
      hold(i, HoldReason::kInTheWay,
           fmt::format("something stands in the way of {} of {} places", sum.differs, sum.compared()), now, report);
    } else {
      notice(i, report);
      const std::string& name = believed.projectors[i].name;
      hold(i, HoldReason::kSearching,
           fruitless < kSearchesSeveralTimes
               ? "it moved, or something hides it; nothing explains yet what the cameras see"
               : fmt::format("nothing that a bump can do explains what the cameras see of it; if nothing hides it, set "
                             "it back and its lens as it was, then calibrate it with 'cyclorama calibrate --quick {}'",
                             name),
           now, report);
    }
  }
}

ContinuousCalibrator::ContinuousCalibrator(std::unique_ptr<State> state) : state_(std::move(state)) {}
ContinuousCalibrator::ContinuousCalibrator(ContinuousCalibrator&&) noexcept = default;
ContinuousCalibrator& ContinuousCalibrator::operator=(ContinuousCalibrator&&) noexcept = default;
ContinuousCalibrator::~ContinuousCalibrator() = default;

Result<ContinuousCalibrator> ContinuousCalibrator::make(const calibration::ShowCalibration& calibration,
                                                        const ContinuousOptions& options) {
  TRY(calibration.validate());
  return ContinuousCalibrator(std::make_unique<State>(calibration, options));
}

Result<ContinuousCalibrator> ContinuousCalibrator::resume(const calibration::ShowCalibration& applied,
                                                          const LearnedRoom& learned,
                                                          const ContinuousOptions& options) {
  const calibration::ShowCalibration& believed = learned.believed;
  TRY(applied.validate());
  TRY(believed.validate());
  const bool is_one_room = applied.projectors.size() == believed.projectors.size() &&
                           applied.cameras.size() == believed.cameras.size() &&
                           applied.projectors.size() == learned.at_rest.size() &&
                           applied.projectors.size() + applied.cameras.size() == learned.roots.size();
  if (!is_one_room)
    return Error(ErrorCode::kInvalidArgument, "what is applied and what was learned belong to different rooms");
  for (const calibration::PoseMatrix& root : learned.roots) {
    if (!root.allFinite() || !root.inverse().allFinite())
      return Error(ErrorCode::kInvalidArgument,
                   "what was learned is more certain than is possible; place the cameras again");
  }
  auto state = std::make_unique<State>(applied, options);
  state->believed = believed;
  state->reference = believed;
  for (std::size_t i = 0; i < learned.at_rest.size(); ++i)
    state->reference.projectors[i].T_room_projector = learned.at_rest[i];
  for (std::size_t i = 0; i < learned.roots.size(); ++i)
    state->filters[i].restart(learned.roots[i] * learned.roots[i].transpose());
  state->is_settled = true;
  return ContinuousCalibrator(std::move(state));
}

void ContinuousCalibrator::realign() { state_->wants_realignment = true; }
Status ContinuousCalibrator::put_back(std::size_t projector,
                                      const RigidTransform<frame::Room, frame::Projector>& T_room_projector) {
  CHECK(projector < state_->projectors());
  if (!state_->is_settled) return Error(ErrorCode::kUnavailable, "it has only begun; wait some seconds");
  // Sets the reference so that the believed pose corresponds to the given one.
  const auto change = state_->scanned.projectors[projector].T_room_projector.inverse() * T_room_projector;
  auto& rest = state_->reference.projectors[projector].T_room_projector;
  rest = state_->believed.projectors[projector].T_room_projector * change.inverse();
  state_->applied.projectors[projector].T_room_projector = T_room_projector;
  state_->health[projector].off_px = 0.0;
  return Done{};
}
bool ContinuousCalibrator::is_settled() const { return state_->is_settled; }

ShowReport ContinuousCalibrator::step(const ShowMoment& moment) {
  State& state = *state_;
  ShowReport report;
  if (std::exchange(state.wants_realignment, false)) {
    state.realigns_until = moment.now + kRealignsFor;
    state.fruitless = 0;
    for (BodyIndex i = 0; i < state.projectors(); ++i) state.loosen(i);  // Cameras are the reference.
  }
  if (!state.begun_at) {
    state.begun_at = moment.now;
    std::ranges::fill(state.measured_at, moment.now);
  }
  for (const ShownPicture& shown : moment.shown) {
    if (shown.projector >= state.timelines.size()) continue;
    const calibration::BrownParameters& lens = state.believed.projectors[shown.projector].lens;
    const bool is_its =
        !shown.picture || (shown.picture->width() == lens.width_px && shown.picture->height() == lens.height_px);
    if (is_its) state.timelines[shown.projector].add(shown);
  }
  for (const ShownUntil& until : moment.until) {
    if (until.projector < state.timelines.size()) state.timelines[until.projector].known_until(until);
  }
  const double passed = state.stepped_at ? std::chrono::duration<double>(moment.now - *state.stepped_at).count() : 0.0;
  for (PoseFilter& filter : state.filters) filter.predict(passed);
  state.stepped_at = state.stepped_at ? std::max(*state.stepped_at, moment.now) : moment.now;
  state.look_at(moment, &report);
  if (!state.looks.empty()) {
    const bool is_lost = !state.lost().empty();
    bool is_recovered = is_lost && state.is_settled && state.recover(moment.now, true, &report);
    if (!is_recovered) {
      for (const CameraObservation& look : state.looks) state.areas[look.camera].update(look.patches);
      const auto solution =
          solve_poses(state.believed, state.trusted_observations(), state.edges(state.looks), state.loose_projectors());
      if (solution) state.learn(moment.now, *solution, &report);
      const bool is_bumped = std::ranges::any_of(state.surprises, [](int n) { return n >= kSurprisesAreABump; });
      const bool creeps = std::ranges::find(state.is_creeping, true) != state.is_creeping.end();
      if ((is_bumped || creeps) && state.is_settled) {
        is_recovered = state.recover(moment.now, false, &report);
        // Displacements without an explanation are followed, and tested again when there are more observations.
        for (std::size_t i = 0; i < state.projectors(); ++i) {
          if (state.is_creeping[i] && !state.is_refused[i]) state.lately[i].forget();
        }
      }
      if (!is_recovered) state.loosen_stubborn();
    }
    state.settle(moment.now);
    state.tell(moment.now, &report);
  }
  state.correct_drift(moment.now, &report);
  report.projectors = state.health;
  return report;
}

const calibration::ShowCalibration& ContinuousCalibrator::believed() const { return state_->believed; }
const calibration::ShowCalibration& ContinuousCalibrator::applied() const { return state_->applied; }
std::optional<LearnedRoom> ContinuousCalibrator::learned() const {
  const State& state = *state_;
  if (!state.is_settled) return std::nullopt;
  LearnedRoom learned{state.believed, {}, {}};
  for (std::size_t i = 0; i < state.projectors(); ++i) {
    const calibration::PoseStep change = calibration::step_between(state.scanned.projectors[i].T_room_projector,
                                                                   state.applied.projectors[i].T_room_projector);
    learned.at_rest.push_back(calibration::stepped(state.reference.projectors[i].T_room_projector, change));
  }
  for (const PoseFilter& filter : state.filters) learned.roots.push_back(filter.root());
  return learned;
}
std::span<const CameraObservation> ContinuousCalibrator::looks() const { return state_->looks; }
const AreaMap& ContinuousCalibrator::areas(std::size_t camera) const {
  CHECK(camera < state_->areas.size());
  return state_->areas[camera];
}

}  // namespace cyclorama::healing
