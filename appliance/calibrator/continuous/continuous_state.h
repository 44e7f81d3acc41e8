// SPDX-License-Identifier: Apache-2.0
/// The inside of ContinuousCalibrator: for its own files alone.
#pragma once

#include <map>

#include "appliance/calibrator/continuous/continuous_calibrator.h"
#include "appliance/calibrator/continuous/feature_matching.h"

namespace cyclorama {

struct ContinuousCalibrator::State {
  State(const ShowCalibration& calibration, const ContinuousOptions& wanted);

  // What is known.
  ContinuousOptions options;
  ShowCalibration scanned;  ///< As it began.
  ShowCalibration believed;
  ShowCalibration applied;
  ShowCalibration reference;        ///< Believed when what the scan left over had been learned.
  std::vector<PoseFilter> filters;  ///< Projectors, then cameras.
  std::vector<PixelMotion> motion;  ///< Per projector.
  std::vector<ProjectorHealth> health;
  std::vector<TimePoint> measured_at;
  std::vector<int> surprises;            ///< Steps in a row whose innovation was too large, per body.
  std::vector<InnovationWindow> lately;  ///< Per projector.
  std::vector<bool> is_creeping;         ///< Small innovations in a row that are no drift, per projector.
  std::vector<bool> is_unanchored;       ///< It or the one camera that sees it moved, per projector.
  std::vector<bool> is_noticed;          ///< It was reported, and has not been found again.
  std::vector<CameraLook> cameras;
  std::vector<AreaMap> areas;
  std::vector<double> gains;  ///< Per camera; 0: not known yet.
  std::vector<ShowTimeline> timelines;
  std::vector<Look> looks;
  std::optional<TimePoint> begun_at;
  std::optional<TimePoint> stepped_at;
  bool is_settled = false;
  int learned = 0;  ///< Steps that taught something.
  bool wants_realignment = false;
  std::optional<TimePoint> realigns_until;
  int fruitless = 0;  ///< Searches in a row that found nothing.

  [[nodiscard]] std::size_t bodies() const { return filters.size(); }
  [[nodiscard]] std::size_t projectors() const { return believed.projectors.size(); }

  // continuous_calibrator.cpp
  void look_at(const ShowMoment& moment, ShowReport* report);
  void learn(TimePoint now, const PoseSolution& solution, ShowReport* report);
  void loosen();
  void settle(TimePoint now);
  void correct_drift(TimePoint now, ShowReport* report);
  void tell(TimePoint now, ShowReport* report);
  void hold(std::size_t projector, Hold why, std::string reason, TimePoint now, ShowReport* report);
  void notice(std::size_t projector, ShowReport* report);

  // bump_recovery.cpp
  [[nodiscard]] std::vector<Sighting> trusted_sightings() const;
  [[nodiscard]] std::vector<EdgeSighting> edges(std::span<const Look> of) const;
  [[nodiscard]] std::vector<BodyPrior> priors() const;
  /// The same, but that the sightings alone say where projectors are: a robust loss would take a bump for gross errors.
  [[nodiscard]] std::vector<BodyPrior> loose_projectors() const;
  /// Projectors of which a camera compared much and hardly anything fits, per camera.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> lost() const;
  /// Tries, in rising cost, what explains the looks. Whether something was found, verified and taken.
  bool recover(TimePoint now, bool is_lost, ShowReport* report);
  bool accept(const Movers& movers, TimePoint now, ShowReport* report);
  /// Whether it can be told who moved: a camera that sees one projector's light and nothing else cannot tell its own
  /// move from that projector's.
  bool are_anchored(std::span<const BodyIndex> movers, std::span<const Look> anew);
  /// All of them, or the first of them that is found alone: one that has left the wall does not keep back the others.
  bool accept_some(const Movers& movers, TimePoint now, ShowReport* report);
  [[nodiscard]] std::optional<Movers> by_patches() const;
  [[nodiscard]] std::optional<Movers> by_coarse_patches() const;
  [[nodiscard]] std::optional<Movers> by_features() const;
};

[[nodiscard]] ShowCalibration moved(const ShowCalibration& room, const PoseSolution& solution,
                                    std::span<const BodyIndex> bodies);
[[nodiscard]] std::string clock_text(TimePoint begun, TimePoint now);

}  // namespace cyclorama
