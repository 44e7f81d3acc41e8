// SPDX-License-Identifier: Apache-2.0
/// State of ContinuousCalibrator; included only by the files that implement it.
#pragma once

#include <map>

#include "appliance/healing/estimator/continuous_calibrator.h"
#include "appliance/healing/estimator/feature_matching.h"

namespace cyclorama::healing {

/// Time for which the show must have stood still before a displacement is accepted without a reference projector.
inline constexpr Duration kCalmFor = std::chrono::milliseconds(1900);

struct ContinuousCalibrator::State {
  State(const calibration::ShowCalibration& calibration, const ContinuousOptions& wanted);

  ContinuousOptions options;
  calibration::ShowCalibration scanned;  ///< Applied poses at the start.
  calibration::ShowCalibration believed;
  calibration::ShowCalibration applied;
  calibration::ShowCalibration reference;  ///< Believed poses that correspond to those of `scanned`.
  std::vector<PoseFilter> filters;         ///< Filters of the projectors, then of the cameras.
  std::vector<PixelMotion> motion;         ///< Per projector.
  std::vector<ProjectorHealth> health;
  std::vector<TimePoint> measured_at;
  std::vector<int> surprises;            ///< Per body: number of successive steps with a too large innovation.
  std::vector<InnovationWindow> lately;  ///< Per projector.
  std::vector<bool> is_creeping;         ///< Per projector: small innovations add up to more than drift.
  std::vector<bool> is_refused;          ///< Per body: a displacement was detected, but no pose was accepted.
  std::vector<double> seems_off_px;      ///< Per projector: distance to the last solution's pose.
  std::vector<bool> is_unanchored;       ///< Per projector: the only camera that sees it may have moved instead.
  std::vector<bool> is_noticed;          ///< Per projector: it was reported as displaced, and not found again since.
  std::vector<CameraMonitor> cameras;
  std::vector<AreaMap> areas;
  std::vector<double> gains;  ///< Per camera; 0: not known yet.
  std::vector<ShowTimeline> timelines;
  std::vector<Duration> times_off;  ///< Per camera: delay of its pictures relative to their time stamps.
  bool is_moving = false;           ///< True if the content moved during the last observations.
  bool is_calm = false;  ///< True if the content stood still for kCalmFor before each of the last observations.
  std::optional<TimePoint> still_at;
  std::vector<CameraObservation> looks;
  std::optional<TimePoint> begun_at;
  std::optional<TimePoint> stepped_at;
  bool is_settled = false;
  int learned = 0;  ///< Number of steps that updated the filters.
  bool wants_realignment = false;
  std::optional<TimePoint> realigns_until;
  int fruitless = 0;  ///< Successive searches without result.

  [[nodiscard]] std::size_t bodies() const { return filters.size(); }
  [[nodiscard]] std::size_t projectors() const { return believed.projectors.size(); }

  // Defined in show_observations.cpp:
  void look_at(const ShowMoment& moment, ShowReport* report);
  std::optional<std::vector<LightPlane>> shone_between(TimePoint opened, TimePoint closed, double* ret_motion_px);
  bool is_still(TimePoint from, TimePoint until);
  /// Returns whether `look` fits the content of its own time better than earlier or later content, while the show
  /// moves. Updates the estimated error of the camera's time stamps.
  bool is_of_its_time(const CameraObservation& look, TimePoint opened, TimePoint closed, TimePoint now,
                      ShowReport* report);

  // Defined in continuous_calibrator.cpp:
  void learn(TimePoint now, const PoseSolution& solution, ShowReport* report);
  /// Resets a body's uncertainty to its initial value, so that the next measurements are followed.
  void loosen(BodyIndex body);
  void loosen_stubborn();
  void settle(TimePoint now);
  void correct_drift(TimePoint now, ShowReport* report);
  void tell(TimePoint now, ShowReport* report);
  void hold(std::size_t projector, HoldReason why, std::string reason, TimePoint now, ShowReport* report);
  void notice(std::size_t projector, ShowReport* report);

  // Defined in bump_recovery.cpp:
  [[nodiscard]] std::vector<PatchObservation> trusted_observations() const;
  [[nodiscard]] std::vector<EdgeObservation> edges(std::span<const CameraObservation> of) const;
  [[nodiscard]] std::vector<BodyPrior> priors() const;
  /// Returns priors(), but with loose_information() for projectors: with a tight prior, a robust loss would treat a
  /// bump as outliers.
  [[nodiscard]] std::vector<BodyPrior> loose_projectors() const;
  /// Returns the pairs (camera, projector) for which many patches were compared and few fit.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> lost() const;
  /// Tries explanations of the observations, the cheapest to compute first. Returns whether one was found, verified and
  /// accepted.
  bool recover(TimePoint now, bool is_lost, ShowReport* report);
  /// Marks bodies for which no pose was accepted. They are not followed until a pose is accepted, or until they are
  /// observed in their former pose.
  void refuse(const MovedBodies& movers);
  bool accept(const MovedBodies& movers, TimePoint now, ShowReport* report);
  /// True if the displacement of `movers` cannot be an error of the time stamps of `of`: the show stood still, or
  /// another projector in the same picture did not move.
  [[nodiscard]] bool have_reference(std::span<const BodyIndex> movers, std::span<const CameraObservation> of) const;
  /// Returns, per body, whether its displacement can be told from that of another body. For a camera that sees only one
  /// projector's light, a displacement of the camera and one of the projector look alike.
  [[nodiscard]] std::vector<bool> anchored(std::span<const CameraObservation> of) const;
  /// Returns whether all of `movers` are anchored(); otherwise sets is_unanchored for the projectors in question.
  bool are_anchored(std::span<const BodyIndex> movers, std::span<const CameraObservation> anew);
  /// Accepts all movers, or else the first one that can be accepted alone, so that a projector whose light has left the
  /// wall does not block the others.
  bool accept_some(const MovedBodies& movers, TimePoint now, ShowReport* report);
  [[nodiscard]] std::optional<MovedBodies> by_patches() const;
  [[nodiscard]] std::optional<MovedBodies> by_coarse_patches() const;
  [[nodiscard]] std::optional<MovedBodies> by_features() const;
};

[[nodiscard]] calibration::ShowCalibration moved(const calibration::ShowCalibration& room, const PoseSolution& solution,
                                                 std::span<const BodyIndex> bodies);
[[nodiscard]] std::string clock_text(TimePoint begun, TimePoint now);

}  // namespace cyclorama::healing
