// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "appliance/healing/estimator/camera_monitor.h"
#include "appliance/healing/estimator/pose_filter.h"
#include "appliance/healing/estimator/pose_solve.h"

namespace cyclorama::healing {

/// Everything that happened since the last step.
struct ShowMoment {
  TimePoint now;
  std::vector<ShownPicture> shown;
  std::vector<ShownUntil> until;    ///< At most one per projector.
  std::vector<CameraPicture> seen;  ///< At most one per camera.
};

/// Reason why a projector is not corrected at present.
enum class HoldReason {
  kNone,
  kSettling,   ///< The first seconds: the scan's residuals are being learned.
  kNoPicture,  ///< There is no camera's picture, or the pictures shown during its exposure are unknown.
  kDark,
  kPlain,
  kFast,
  kBlown,
  kInTheWay,
  kNoLight,    ///< The projector's part of the wall is dark and should not be.
  kSearching,  ///< Something moved, and no pose explains it yet.
  kUnplaced,   ///< The calibration has no pose of the projector.
};
[[nodiscard]] std::string_view name_of(HoldReason hold);

/// A projector that is drawn for another pose from now on.
struct Correction {
  std::size_t projector = 0;
  RigidTransform<frame::Room, frame::Projector> before;
  RigidTransform<frame::Room, frame::Projector> after;
  double moved_px = 0.0;  ///< Root mean square displacement over the picture.
  double sigma_px = 0.0;  ///< Standard deviation of the new pose.
  bool is_bump = false;   ///< True for a bump, false for drift.
};

struct ProjectorHealth {
  HoldReason hold = HoldReason::kSettling;
  std::string reason;       ///< For operators; empty while all is well.
  double off_px = 0.0;      ///< Distance between the believed and the applied pose, in the calibration's pixels.
  double sigma_px = 0.0;    ///< Standard deviation of `off_px`.
  bool wants_scan = false;  ///< The projector has no pose, or its last measurement is older than scan_wanted_after.
};

struct ShowReport {
  std::vector<Correction> corrections;
  std::vector<ProjectorHealth> projectors;
  /// Projectors whose displacement was detected, whether or not the new pose is found.
  std::vector<std::size_t> noticed;
  std::vector<std::string> log;  ///< A line per correction, and per change of a hold.
};

struct ContinuousOptions {
  int width_px = 816;         ///< Approximate width of the reduced camera pictures.
  PatchOptions patches = {};  ///< Spacing, size and limits of the patches that are compared.
  double min_sigma_px = 0.3;  ///< Lower bound of an observation's sigma, in the calibration's pixels.
  /// Factor by which the calibration's pictures are smaller than the projectors', each way.
  double pixels = 1.0;
  /// In the projectors' pixels. Smaller drift is not corrected, since the correction would be more visible than the
  /// drift.
  double correct_from_px = 0.2;
  double correct_from_sigmas = 4.0;  ///< Minimum significance of corrected drift: `normal` of innovation_limit().
  Duration settle = std::chrono::seconds(3);
  Duration scan_wanted_after = std::chrono::minutes(5);
  double fastest_px = 1.5;  ///< Maximum motion of the content during an exposure, in pixels of the reduced picture.
  PoseFilter::Walk walk = {};
  bool uses_arcs = true;   ///< Uses the wall's upper and lower edge to locate the cameras.
  bool uses_sides = true;  ///< Also uses the wall's upright sides.
};

/// Everything that has been learned about a room, with which another calibrator resumes.
struct LearnedRoom {
  calibration::ShowCalibration believed;  ///< Believed poses.
  /// Per projector, the believed pose that corresponds to the applied one; the two differ by the scan's residuals.
  std::vector<RigidTransform<frame::Room, frame::Projector>> at_rest;
  std::vector<calibration::PoseMatrix> roots;  ///< Uncertainties: PoseFilter::root() per projector, then per camera.
};

/// Keeps a calibration accurate while the show goes on, from the pictures of fixed cameras.
///
///     shown pictures ─▶ predict ─┐
///     camera pictures ───────────┴▶ compare ─▶ fits ──▶ solve ─▶ filter ─────────────▶ (drift beyond 0.2 px) correct
///                                     │          innovation too large ─┐
///                                     └▶ differs ─▶ occluded? dark? ─┴▶ who moved? ─▶ predict again ─▶ correct
///                                                   hold, with reason     hold, with reason └ not better: hold
///
/// 1. The result depends on state and input alone: a recorded show gives the same corrections again.
/// 2. A step without a solution changes no believed pose.
/// 3. A pose is accepted only if the prediction made from it fits more of the picture than before.
/// 4. While the show moves, a picture counts only if it fits the content of its own time better than earlier or later
///    content, and a projector counts as moved only if another projector in the same picture did not move.
///
/// Used by the calibrator process and by replays. Thread-bound; a step takes tenths of a second and belongs in a thread
/// that no refresh waits for.
class ContinuousCalibrator {
 public:
  /// Starts with a new calibration. Errors: those of ShowCalibration::validate().
  static Result<ContinuousCalibrator> make(const calibration::ShowCalibration& calibration,
                                           const ContinuousOptions& options = {});
  /// Resumes the state of another calibrator: `applied` has the poses for which displays draw, `learned` is the other
  /// calibrator's learned(). The uncertainties are kept, so that a displacement in the meantime counts as a bump, not
  /// as drift. Errors: those of make(); kInvalidArgument if the two are of different rooms, or an uncertainty is not
  /// positive.
  static Result<ContinuousCalibrator> resume(const calibration::ShowCalibration& applied, const LearnedRoom& learned,
                                             const ContinuousOptions& options = {});
  ContinuousCalibrator(ContinuousCalibrator&&) noexcept;
  ContinuousCalibrator& operator=(ContinuousCalibrator&&) noexcept;
  ~ContinuousCalibrator();

  ShowReport step(const ShowMoment& moment);
  /// Requests a realignment: at the next step the projectors' uncertainties are reset to those of a new scan, and for
  /// ten seconds displacements are corrected from 0.05 px on.
  void realign();
  /// Handles a correction by the operator. From now on, displays draw the projector's picture for `T_room_projector`,
  /// and this pose counts as correct for the projector's present position, so that only later displacements are
  /// corrected. Precondition: the projector exists. Errors: kUnavailable if the calibrator is not settled yet.
  Status put_back(std::size_t projector, const RigidTransform<frame::Room, frame::Projector>& T_room_projector);
  /// Returns whether the scan's residuals have been learned.
  [[nodiscard]] bool is_settled() const;

  /// Returns the believed poses of all projectors and cameras.
  [[nodiscard]] const calibration::ShowCalibration& believed() const;
  /// Returns the poses for which displays draw: the calibration with all corrections.
  [[nodiscard]] const calibration::ShowCalibration& applied() const;
  /// Returns what has been learned; empty until is_settled().
  [[nodiscard]] std::optional<LearnedRoom> learned() const;
  /// Returns the observations of the last step, for pages and benchmarks.
  [[nodiscard]] std::span<const CameraObservation> looks() const;
  [[nodiscard]] const AreaMap& areas(std::size_t camera) const;

 private:
  struct State;
  explicit ContinuousCalibrator(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::healing
