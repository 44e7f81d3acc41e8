// SPDX-License-Identifier: Apache-2.0
/// The inside of ContinuousCalibrator: for its own files alone.
#pragma once

#include <map>

#include "appliance/healing/estimator/continuous_calibrator.h"
#include "appliance/healing/estimator/feature_matching.h"

namespace cyclorama::healing {

/// So long has the show to stand still before somebody's move is believed that nobody else can reference.
inline constexpr Duration kCalmFor = std::chrono::milliseconds(1900);

struct ContinuousCalibrator::State {
  State(const calibration::ShowCalibration& calibration, const ContinuousOptions& wanted);

  // What is known.
  ContinuousOptions options;
  calibration::ShowCalibration scanned;  ///< As it began.
  calibration::ShowCalibration believed;
  calibration::ShowCalibration applied;
  calibration::ShowCalibration reference;  ///< Believed when what the scan left over had been learned.
  std::vector<PoseFilter> filters;         ///< Projectors, then cameras.
  std::vector<PixelMotion> motion;         ///< Per projector.
  std::vector<ProjectorHealth> health;
  std::vector<TimePoint> measured_at;
  std::vector<int> surprises;            ///< Steps in a row whose innovation was too large, per body.
  std::vector<InnovationWindow> lately;  ///< Per projector.
  std::vector<bool> is_creeping;         ///< Small innovations in a row that are no drift, per projector.
  std::vector<bool> is_refused;          ///< It seems to have moved, but no place was accepted, per body.
  std::vector<double> seems_off_px;      ///< Where the last solution would put it, per projector.
  std::vector<bool> is_unanchored;       ///< It or the one camera that sees it moved, per projector.
  std::vector<bool> is_noticed;          ///< It was reported, and has not been found again.
  std::vector<CameraMonitor> cameras;
  std::vector<AreaMap> areas;
  std::vector<double> gains;  ///< Per camera; 0: not known yet.
  std::vector<ShowTimeline> timelines;
  std::vector<Duration> times_off;  ///< Per camera: how much later its pictures are than they say.
  bool is_moving = false;           ///< What is shown, while the last looks were taken.
  bool is_calm = false;             ///< It stood still long before them, too: no clock can be so wrong.
  std::optional<TimePoint> still_at;
  std::vector<CameraObservation> looks;
  std::optional<TimePoint> begun_at;
  std::optional<TimePoint> stepped_at;
  bool is_settled = false;
  int learned = 0;  ///< Steps that taught something.
  bool wants_realignment = false;
  std::optional<TimePoint> realigns_until;
  int fruitless = 0;  ///< Searches in a row that found nothing.

  [[nodiscard]] std::size_t bodies() const { return filters.size(); }
  [[nodiscard]] std::size_t projectors() const { return believed.projectors.size(); }

  // show_looks.cpp
  void look_at(const ShowMoment& moment, ShowReport* report);
  std::optional<std::vector<LightPlane>> shone_between(TimePoint opened, TimePoint closed, double* ret_motion_px);
  bool is_still(TimePoint from, TimePoint until);
  /// While the show moves: whether a look fits the time that it says better than a little earlier or later. Learns how
  /// wrong the time is.
  bool is_of_its_time(const CameraObservation& look, TimePoint opened, TimePoint closed, TimePoint now,
                      ShowReport* report);

  // continuous_calibrator.cpp
  void learn(TimePoint now, const PoseSolution& solution, ShowReport* report);
  /// What was known of a body is forgotten: the next measurement is followed.
  void loosen(BodyIndex body);
  void loosen_stubborn();
  void settle(TimePoint now);
  void correct_drift(TimePoint now, ShowReport* report);
  void tell(TimePoint now, ShowReport* report);
  void hold(std::size_t projector, HoldReason why, std::string reason, TimePoint now, ShowReport* report);
  void notice(std::size_t projector, ShowReport* report);

  // bump_recovery.cpp
  [[nodiscard]] std::vector<PatchObservation> trusted_observations() const;
  [[nodiscard]] std::vector<EdgeObservation> edges(std::span<const CameraObservation> of) const;
  [[nodiscard]] std::vector<BodyPrior> priors() const;
  /// The same, but that the observations alone say where projectors are: a robust loss would take a bump for gross errors.
  [[nodiscard]] std::vector<BodyPrior> loose_projectors() const;
  /// Projectors of which a camera compared much and hardly anything fits, per camera.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> lost() const;
  /// Tries, in rising cost, what explains the looks. Whether something was found, verified and taken.
  bool recover(TimePoint now, bool is_lost, ShowReport* report);
  /// No place was accepted for these: until one is, or they are seen where they were, they are not followed either.
  void refuse(const MovedBodies& movers);
  bool accept(const MovedBodies& movers, TimePoint now, ShowReport* report);
  /// Whether the times are right with which `of` says that these moved: by calm, or by a projector that did not.
  [[nodiscard]] bool have_reference(std::span<const BodyIndex> movers, std::span<const CameraObservation> of) const;
  /// Of which it can be told who moved: a camera that sees one projector's light and nothing else cannot tell its own
  /// move from that projector's.
  [[nodiscard]] std::vector<bool> anchored(std::span<const CameraObservation> of) const;
  /// Whether all of these are; else says whose they are that are not.
  bool are_anchored(std::span<const BodyIndex> movers, std::span<const CameraObservation> anew);
  /// All of them, or the first of them that is found alone: one that has left the wall does not keep back the others.
  bool accept_some(const MovedBodies& movers, TimePoint now, ShowReport* report);
  [[nodiscard]] std::optional<MovedBodies> by_patches() const;
  [[nodiscard]] std::optional<MovedBodies> by_coarse_patches() const;
  [[nodiscard]] std::optional<MovedBodies> by_features() const;
};

[[nodiscard]] calibration::ShowCalibration moved(const calibration::ShowCalibration& room, const PoseSolution& solution,
                                                 std::span<const BodyIndex> bodies);
[[nodiscard]] std::string clock_text(TimePoint begun, TimePoint now);

}  // namespace cyclorama::healing
