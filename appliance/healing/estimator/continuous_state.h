// SPDX-License-Identifier: Apache-2.0
/// State of ContinuousCalibrator, for its own files only.
#pragma once

#include <map>

#include "appliance/healing/estimator/continuous_calibrator.h"
#include "appliance/healing/estimator/feature_matching.h"

namespace cyclorama::healing {

/// Time for which the show must stand still before a displacement is accepted without a reference projector.
inline constexpr Duration kCalmFor = std::chrono::milliseconds(1900);

struct ContinuousCalibrator::State {
  State(const calibration::ShowCalibration& calibration, const ContinuousOptions& wanted);

  ContinuousOptions options;
  calibration::ShowCalibration scanned;  ///< Initial state.
  calibration::ShowCalibration believed;
  calibration::ShowCalibration applied;
  calibration::ShowCalibration reference;  ///< Believed poses at the time when the scan's residuals had been learned.
  std::vector<PoseFilter> filters;         ///< Values of the projectors, then of the cameras.
  std::vector<PixelMotion> motion;         ///< Per projector.
  std::vector<ProjectorHealth> health;
  std::vector<TimePoint> measured_at;
  std::vector<int> surprises;            ///< Steps in a row whose innovation was too large, per body.
  std::vector<InnovationWindow> lately;  ///< Per projector.
  std::vector<bool> is_creeping;         ///< Small innovations add up to more than drift explains, per projector.
  std::vector<bool> is_refused;          ///< A displacement was detected, but no pose was accepted, per body.
  std::vector<double> seems_off_px;      ///< Distance to the last solution's pose, per projector.
  std::vector<bool> is_unanchored;       ///< Either the projector or the only camera that sees it moved, per projector.
  std::vector<bool> is_noticed;          ///< Reported as displaced, and not found again since.
  std::vector<CameraMonitor> cameras;
  std::vector<AreaMap> areas;
  std::vector<double> gains;  ///< Per camera; 0: not known yet.
  std::vector<ShowTimeline> timelines;
  std::vector<Duration> times_off;  ///< Per camera: delay of its pictures relative to their time stamps.
  bool is_moving = false;           ///< The content moved during the last observations.
  bool is_calm = false;  ///< The content also stood still for longer before them than any clock can be wrong.
  std::optional<TimePoint> still_at;
  std::vector<CameraObservation> looks;
  std::optional<TimePoint> begun_at;
  std::optional<TimePoint> stepped_at;
  bool is_settled = false;
  int learned = 0;  ///< Steps that added knowledge.
  bool wants_realignment = false;
  std::optional<TimePoint> realigns_until;
  int fruitless = 0;  ///< Successive searches without result.

  [[nodiscard]] std::size_t bodies() const { return filters.size(); }
  [[nodiscard]] std::size_t projectors() const { return believed.projectors.size(); }

  // Defined in show_observations.cpp:
  void look_at(const ShowMoment& moment, ShowReport* report);
  std::optional<std::vector<LightPlane>> shone_between(TimePoint opened, TimePoint closed, double* ret_motion_px);
  bool is_still(TimePoint from, TimePoint until);
  /// Returns whether `look` fits its own time better than a little earlier or later, while the show moves. Learns the
  /// error of the time stamps.
  bool is_of_its_time(const CameraObservation& look, TimePoint opened, TimePoint closed, TimePoint now,
                      ShowReport* report);

  // Defined in continuous_calibrator.cpp:
  void learn(TimePoint now, const PoseSolution& solution, ShowReport* report);
  /// Forgets what was known of a body, so that the next measurement is followed.
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
  /// Same as priors(), but observations alone decide on projectors: a robust loss would take a bump for gross errors.
  [[nodiscard]] std::vector<BodyPrior> loose_projectors() const;
  /// Pairs of projector and camera where much was compared and hardly anything fits.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> lost() const;
  /// Tries explanations of the observations, in order of cost. Returns whether one was found, verified and accepted.
  bool recover(TimePoint now, bool is_lost, ShowReport* report);
  /// Marks bodies for which no pose was accepted. They are not followed until a pose is accepted, or until they are
  /// observed in their former pose.
  void refuse(const MovedBodies& movers);
  bool accept(const MovedBodies& movers, TimePoint now, ShowReport* report);
  /// True if the time stamps of `of` are confirmed for a displacement of these: by a still show, or by a projector that
  /// did not move.
  [[nodiscard]] bool have_reference(std::span<const BodyIndex> movers, std::span<const CameraObservation> of) const;
  /// Bodies whose displacement can be told from others': a camera that sees one projector's light and nothing else
  /// cannot distinguish its own displacement from that projector's.
  [[nodiscard]] std::vector<bool> anchored(std::span<const CameraObservation> of) const;
  /// Returns whether all of `movers` can be told from others; marks the projectors among them that cannot.
  bool are_anchored(std::span<const BodyIndex> movers, std::span<const CameraObservation> anew);
  /// Accepts all of them, or the first that can be accepted alone, so that one that has left the wall does not block
  /// the others.
  bool accept_some(const MovedBodies& movers, TimePoint now, ShowReport* report);
  [[nodiscard]] std::optional<MovedBodies> by_patches() const;
  [[nodiscard]] std::optional<MovedBodies> by_coarse_patches() const;
  [[nodiscard]] std::optional<MovedBodies> by_features() const;
};

[[nodiscard]] calibration::ShowCalibration moved(const calibration::ShowCalibration& room, const PoseSolution& solution,
                                                 std::span<const BodyIndex> bodies);
[[nodiscard]] std::string clock_text(TimePoint begun, TimePoint now);

}  // namespace cyclorama::healing
