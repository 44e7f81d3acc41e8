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

/// What happened since the last step.
struct ShowMoment {
  TimePoint now;
  std::vector<ShownPicture> shown;
  std::vector<ShownUntil> until;    ///< Per projector; of one that is not there nothing new is known.
  std::vector<CameraPicture> seen;  ///< At most one per camera.
};

/// Why a projector is not being corrected just now.
enum class HoldReason {
  kNone,
  kSettling,   ///< The first seconds: what the last scan left over is being learned.
  kNoPicture,  ///< No camera's picture, or nothing is known of what was shown during its exposure.
  kDark,
  kPlain,
  kFast,
  kBlown,
  kInTheWay,
  kNoLight,    ///< Its part of the wall is dark and should not be.
  kSearching,  ///< Something moved, and no pose explains it yet.
  kUnplaced,   ///< The calibration does not say where it stands.
};
[[nodiscard]] std::string_view name_of(HoldReason hold);

/// A projector that is drawn for from another place from now on.
struct Correction {
  std::size_t projector = 0;
  RigidTransform<frame::Room, frame::Projector> before;
  RigidTransform<frame::Room, frame::Projector> after;
  double moved_px = 0.0;  ///< Root mean square over its picture.
  double sigma_px = 0.0;  ///< How sure the new place is.
  bool is_bump = false;   ///< Or slow drift.
};

struct ProjectorHealth {
  HoldReason hold = HoldReason::kSettling;
  std::string reason;       ///< For people; empty while all is well.
  double off_px = 0.0;      ///< Between where it is believed to be and what is drawn for.
  double sigma_px = 0.0;    ///< How sure that is.
  bool wants_scan = false;  ///< Uncertain for so long that test patterns should be shown, out of hours.
};

struct ShowReport {
  std::vector<Correction> corrections;
  std::vector<ProjectorHealth> projectors;
  std::vector<std::size_t> noticed;  ///< Projectors that were found to have moved, whether or not they are found again.
  std::vector<std::string> log;      ///< A line per correction, and per change of what holds it.
};

struct ContinuousOptions {
  int width_px = 816;            ///< About how wide cameras' pictures are looked at.
  PatchOptions patches = {};     ///< How densely, and in how large parts, they are compared.
  double min_sigma_px = 0.3;     ///< No patch_observation is better, in the calibration's pixels.
  double pixels = 1.0;           ///< Of the projectors, for one of the calibration's: its pictures are smaller by that.
  double correct_from_px = 0.2;  ///< Drift of less stays as it is: correcting would be seen more than the error. Of the
                                 ///< projectors' pixels.
  double correct_from_sigmas = 4.0;  ///< As unlikely as a normal variable beyond so many, all directions together.
  Duration settle = std::chrono::seconds(3);
  Duration scan_wanted_after = std::chrono::minutes(5);
  double fastest_px = 1.5;  ///< Content's way during an exposure, in pixels of the reduced picture.
  PoseFilter::Walk walk = {};
  bool uses_arcs = true;   ///< The wall's upper and lower edge hold the cameras.
  bool uses_sides = true;  ///< Its upright sides, alike.
};

/// What has been learned of a room, for another one to go on with.
struct LearnedRoom {
  calibration::ShowCalibration believed;  ///< Where all is believed to stand.
  /// Per projector, where it would be believed to stand if what is applied were right: what the scan left over, without
  /// what is about to be corrected.
  std::vector<RigidTransform<frame::Room, frame::Projector>> at_rest;
  std::vector<calibration::PoseMatrix> roots;  ///< How sure that is: PoseFilter::root() per projector, then per camera.
};

/// Keeps a calibration true while the show goes on, by what fixed cameras see of it.
///
///     shown pictures ─▶ predict ─┐
///     camera pictures ───────────┴▶ compare ─▶ fits ──▶ solve ─▶ filter ─────────────▶ (drift beyond 0.2 px) correct
///                                     │          innovation too large ─┐
///                                     └▶ differs ─▶ in the way? dark? ─┴▶ who moved? ─▶ predict again ─▶ correct
///                                                   hold, say why         hold, say why      └ not better: hold
///
/// 1. Its answer depends on its state and its input alone: a recorded show gives the same corrections again.
/// 2. A step that fails changes nothing.
/// 3. No pose is taken that does not, predicted anew, make more of the picture fit than before.
/// 4. While the show moves, a picture counts only if it fits the time that it says better than a little earlier and
///    later, and a projector that moved only if another one, in the same picture, did not.
///
/// Used by the calibrator process and by replays. Thread-bound; a step takes tenths of a second and belongs in a thread
/// that no refresh waits for.
class ContinuousCalibrator {
 public:
  /// Errors of ShowCalibration::validate().
  static Result<ContinuousCalibrator> make(const calibration::ShowCalibration& calibration,
                                           const ContinuousOptions& options = {});
  /// Goes on where another one was when it ended, in mid-recovery too: `applied` is what displays draw for, `learned`
  /// what the other one knew. It is as sure as that one was, so what moved meanwhile is a bump, not drift. Errors
  /// alike.
  static Result<ContinuousCalibrator> resume(const calibration::ShowCalibration& applied, const LearnedRoom& learned,
                                             const ContinuousOptions& options = {});
  ContinuousCalibrator(ContinuousCalibrator&&) noexcept;
  ContinuousCalibrator& operator=(ContinuousCalibrator&&) noexcept;
  ~ContinuousCalibrator();

  ShowReport step(const ShowMoment& moment);
  /// Somebody wants it now: for ten seconds every projector is searched for as if nothing were known of late, and what
  /// is found is corrected from 0.05 px on.
  void realign();
  /// Somebody knows better: the displays draw for this place of a projector from now on, and how all is seen now counts
  /// as right with it. kUnavailable  it is not settled yet.
  Status put_back(std::size_t projector, const RigidTransform<frame::Room, frame::Projector>& T_room_projector);
  /// Whether what the scan left over has been learned.
  [[nodiscard]] bool is_settled() const;

  /// Where all is believed to be.
  [[nodiscard]] const calibration::ShowCalibration& believed() const;
  /// What the displays draw for: the calibration and all corrections.
  [[nodiscard]] const calibration::ShowCalibration& applied() const;
  /// Nothing before it is settled.
  [[nodiscard]] std::optional<LearnedRoom> learned() const;
  /// Of the last step, for pages and benchmarks.
  [[nodiscard]] std::span<const CameraObservation> looks() const;
  [[nodiscard]] const AreaMap& areas(std::size_t camera) const;

 private:
  struct State;
  explicit ContinuousCalibrator(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::healing
