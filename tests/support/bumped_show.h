// SPDX-License-Identifier: Apache-2.0
/// A show in a simulated museum that continues while projectors are bumped: displays that draw a panorama, fixed
/// cameras, and the continuous calibration between them. For tests and benchmarks. The truth is used only for scoring.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "appliance/healing/estimator/continuous_calibrator.h"
#include "common/geometry/panorama.h"
#include "drivers/simulated/museum/flaws.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/museum/simulated_show.h"
#include "tests/data_sets/left_over.h"

namespace cyclorama {

/// Code values for all directions from the eye.
struct ShowContent {
  Panorama shape;
  RgbImage picture;
};
/// Paints a full turn of rock-like content from smooth noise and blotches with edges.
[[nodiscard]] ShowContent painted_content(int width_px, std::uint32_t seed);
/// Reads a rendered PNG file that spans a full turn. Errors: those of read_file() and decode_png().
Result<ShowContent> read_content(const std::string& path, double tan_top, double tan_bottom);

struct BumpedShowOptions {
  std::string museum = "cylinder126";
  std::uint32_t seed = 1;
  int projectors = 3;
  int projector_width_px = 1920;
  int projector_height_px = 1080;
  double camera_megapixels = 2.0;
  double camera_field_deg = 80.0;
  /// If not 0, all cameras are beside the middle projector, at this distance from one another.
  double camera_apart_m = 0.0;
  int wall_cells = 64;  ///< Number of wall cells for inter-reflection.
  double exposure_s = 0.04;
  Duration period = std::chrono::milliseconds(250);  ///< Time per step.
  double turn_rad_s = 0.0;                           ///< Turning speed of the visitor.
  LeftOver left_over = {};                           ///< Residual errors of the initial calibration.
  healing::ContinuousOptions calibrator = {};
  int threads = 1;
};

/// Thread-bound.
class BumpedShow {
 public:
  static Result<BumpedShow> make(const BumpedShowOptions& options, ShowContent content);

  /// Advances by one period: the displays draw for the estimated poses, the cameras take pictures, and the calibration
  /// takes a step.
  Result<healing::ShowReport> step();
  /// Advances likewise, but returns the input of the calibration's step for an external calibration instead of taking
  /// it.
  Result<healing::ShowMoment> look();
  /// Sets the pose for which a display draws. Takes effect at the next step.
  void draw_for(std::size_t projector, const RigidTransform<frame::Room, frame::Projector>& pose) {
    draws_for_[projector] = pose;
  }
  /// Marks everything as unreported, so that the next step reports it again.
  void forget_told() { is_changed_ = is_untold_ = true; }
  [[nodiscard]] const std::string& installation_text() const { return installation_text_; }

  /// Restarts the calibrator like a process that was killed and restores its saved state.
  Status restart();
  void bump(std::size_t projector, const calibration::PoseStep& step);
  void bump_camera(std::size_t camera, const calibration::PoseStep& step);
  simulated::SimulatedShow& room() { return *room_; }
  /// Returns the last input of the calibration.
  [[nodiscard]] const healing::ShowMoment& last_moment() const { return moment_; }
  [[nodiscard]] healing::ContinuousCalibrator& calibrator() { return *calibrator_; }
  void set_content(ShowContent content) {
    content_ = std::move(content);
    is_changed_ = true;
  }
  /// Sets a function that modifies the input of each step, for example with wrong clocks or lost reports.
  void set_teller(std::function<void(healing::ShowMoment*)> teller) { teller_ = std::move(teller); }
  void set_turn(double turn_rad_s) { options_.turn_rad_s = turn_rad_s; }
  void set_period(Duration period) { options_.period = period; }
  void set_lamp(std::size_t projector, bool is_on) {
    is_changed_ = is_changed_ || is_on_[projector] != is_on;
    is_on_[projector] = is_on;
  }
  [[nodiscard]] double now_s() const { return std::chrono::duration<double>(now_ - TimePoint{}).count(); }
  /// Returns the CPU time of the calibration so far.
  [[nodiscard]] double calibrator_cpu_s() const { return cpu_s_; }

  /// Returns the true error of a projector's pixels as seen from the sweet spot: the map's residual errors, and
  /// displacements that were not corrected or were corrected wrongly. `percentile` in [0, 1] is over the projector's
  /// picture.
  [[nodiscard]] double error_px(std::size_t projector, double percentile = 0.95) const;
  /// Returns error_px() for the poses for which the displays draw at present.
  [[nodiscard]] double drawn_error_px(std::size_t projector, double percentile = 0.95) const;
  [[nodiscard]] std::size_t projector_count() const { return is_on_.size(); }
  /// Returns the picture that a head shows at present.
  [[nodiscard]] const RgbImage& head(std::size_t projector) const { return *heads_[projector]; }

 private:
  BumpedShow(const BumpedShowOptions& options, ShowContent content, simulated::SimulatedShow room,
             healing::ContinuousCalibrator calibrator, calibration::ShowCalibration truth,
             std::string installation_text);
  [[nodiscard]] RgbImage draw(std::size_t projector) const;
  [[nodiscard]] double off_px(std::size_t projector, const calibration::ShowProjector& drawn_for,
                              double percentile) const;
  /// Returns the pixel that the model computes for the direction that `pixel` truly lights; nothing beside the wall.
  [[nodiscard]] std::optional<Eigen::Vector2d> drawn_at(std::size_t projector,
                                                        const calibration::ShowProjector& drawn_for,
                                                        const Eigen::Vector2d& pixel) const;

  BumpedShowOptions options_;
  ShowContent content_;
  calibration::ShowCalibration truth_;                      ///< Truth at the start.
  std::vector<std::vector<Eigen::Vector2d>> left_over_px_;  ///< Residual error per projector at each scored pixel.
  std::unique_ptr<simulated::SimulatedShow> room_;
  std::unique_ptr<healing::ContinuousCalibrator> calibrator_;
  std::vector<std::shared_ptr<const RgbImage>> heads_;
  std::vector<bool> is_on_;
  std::vector<bool> is_moved_;  ///< True for projectors that were moved since the last step.
  std::string installation_text_;
  std::vector<RigidTransform<frame::Room, frame::Projector>> draws_for_;
  std::vector<RigidTransform<frame::Room, frame::Projector>> drawn_for_;
  double drawn_heading_rad_ = 0.0;
  bool is_changed_ = true;  ///< True if what is drawn, or a lamp, has changed.
  TimePoint now_ = TimePoint{} + std::chrono::seconds(100);
  double heading_rad_ = 0.0;
  healing::ShowMoment moment_;
  bool is_untold_ = true;
  std::uint64_t number_ = 0;  ///< Number of pictures that each head has shown.
  std::function<void(healing::ShowMoment*)> teller_;
  double cpu_s_ = 0.0;
};

/// Returns a random displacement in one of six degrees of freedom, or in all.
[[nodiscard]] calibration::PoseStep drawn_bump(simulated::RandomStream* draws);

}  // namespace cyclorama
