// SPDX-License-Identifier: Apache-2.0
/// A show in a simulated museum that runs while projectors are bumped: displays that draw a panorama, fixed cameras,
/// and the continuous calibration between them. For tests and benchmarks; the truth is only used to score.
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

/// All directions about the eye, as code values.
struct ShowContent {
  Panorama shape;
  RgbImage picture;
};
/// Painted by sums of smooth noise and blotches with edges: something like rock. A whole turn.
[[nodiscard]] ShowContent painted_content(int width_px, std::uint32_t seed);
/// A rendered PNG of a whole turn. Errors of read_png().
Result<ShowContent> read_content(const std::string& path, double tan_top, double tan_bottom);

struct BumpedShowOptions {
  std::string museum = "cylinder126";
  std::uint32_t seed = 1;
  int projectors = 3;
  int projector_width_px = 1920;
  int projector_height_px = 1080;
  double camera_megapixels = 2.0;
  double camera_field_deg = 80.0;
  double camera_apart_m = 0.0;  ///< Not 0: all beside the projector in the middle, so far from each other.
  int wall_cells = 64;          ///< That throw light at each other.
  double exposure_s = 0.04;
  Duration period = std::chrono::milliseconds(250);  ///< From one step to the next.
  double turn_rad_s = 0.0;                           ///< The visitor's.
  LeftOver left_over = {};                           ///< Of the calibration that the show goes on from.
  healing::ContinuousOptions calibrator = {};
  int threads = 1;
};

/// Thread-bound.
class BumpedShow {
 public:
  static Result<BumpedShow> make(const BumpedShowOptions& options, ShowContent content);

  /// One period: the displays draw for where projectors are believed to be, cameras look, the calibration steps.
  Result<healing::ShowReport> step();
  /// The same for a calibration that somebody else makes: what it is to be told.
  Result<healing::ShowMoment> look();
  /// From the next look on.
  void draw_for(std::size_t projector, const RigidTransform<frame::Room, frame::Projector>& pose) {
    draws_for_[projector] = pose;
  }
  /// Nobody knows what is being shown: it is told anew.
  void forget_told() { is_changed_ = is_untold_ = true; }
  [[nodiscard]] const std::string& installation_text() const { return installation_text_; }

  /// As a calibrator's process that was killed, and came back with what it had kept.
  Status restart();
  void bump(std::size_t projector, const calibration::PoseStep& step);
  void bump_camera(std::size_t camera, const calibration::PoseStep& step);
  simulated::SimulatedShow& room() { return *room_; }
  /// What the last step gave the calibration.
  [[nodiscard]] const healing::ShowMoment& last_moment() const { return moment_; }
  [[nodiscard]] healing::ContinuousCalibrator& calibrator() { return *calibrator_; }
  void set_content(ShowContent content) {
    content_ = std::move(content);
    is_changed_ = true;
  }
  /// Changes what the calibration is told of each moment: clocks that are wrong, reports that are lost.
  void set_teller(std::function<void(healing::ShowMoment*)> teller) { teller_ = std::move(teller); }
  void set_turn(double turn_rad_s) { options_.turn_rad_s = turn_rad_s; }
  void set_period(Duration period) { options_.period = period; }
  void set_lamp(std::size_t projector, bool is_on) {
    is_changed_ = is_changed_ || is_on_[projector] != is_on;
    is_on_[projector] = is_on;
  }
  [[nodiscard]] double now_s() const { return std::chrono::duration<double>(now_ - TimePoint{}).count(); }
  /// Cpu time of the calibration alone, so far.
  [[nodiscard]] double calibrator_cpu_s() const { return cpu_s_; }

  /// How far a projector's pixels are from where they are drawn for, by the truth, as seen from the sweet spot: the
  /// map's own errors and what was not corrected, or wrongly, since; percentile in [0, 1] of its picture.
  [[nodiscard]] double error_px(std::size_t projector, double percentile = 0.95) const;
  /// The same of what the displays draw for now.
  [[nodiscard]] double drawn_error_px(std::size_t projector, double percentile = 0.95) const;
  [[nodiscard]] std::size_t projector_count() const { return is_on_.size(); }
  /// What a head shows now.
  [[nodiscard]] const RgbImage& head(std::size_t projector) const { return *heads_[projector]; }

 private:
  BumpedShow(const BumpedShowOptions& options, ShowContent content, simulated::SimulatedShow room,
             healing::ContinuousCalibrator calibrator, calibration::ShowCalibration truth,
             std::string installation_text);
  [[nodiscard]] RgbImage draw(std::size_t projector) const;
  [[nodiscard]] double off_px(std::size_t projector, const calibration::ShowProjector& drawn_for,
                              double percentile) const;
  /// The pixel by which the model draws what a pixel lights; nothing beside the wall.
  [[nodiscard]] std::optional<Eigen::Vector2d> drawn_at(std::size_t projector,
                                                        const calibration::ShowProjector& drawn_for,
                                                        const Eigen::Vector2d& pixel) const;

  BumpedShowOptions options_;
  ShowContent content_;
  calibration::ShowCalibration truth_;                      ///< As it began.
  std::vector<std::vector<Eigen::Vector2d>> left_over_px_;  ///< Per projector, at each scored pixel.
  std::unique_ptr<simulated::SimulatedShow> room_;
  std::unique_ptr<healing::ContinuousCalibrator> calibrator_;
  std::vector<std::shared_ptr<const RgbImage>> heads_;
  std::vector<bool> is_on_;
  std::vector<bool> is_moved_;  ///< Since the last look.
  std::string installation_text_;
  std::vector<RigidTransform<frame::Room, frame::Projector>> draws_for_;
  std::vector<RigidTransform<frame::Room, frame::Projector>> drawn_for_;
  double drawn_heading_rad_ = 0.0;
  bool is_changed_ = true;  ///< What is to be drawn, or which lamps are on.
  TimePoint now_ = TimePoint{} + std::chrono::seconds(100);
  double heading_rad_ = 0.0;
  healing::ShowMoment moment_;
  bool is_untold_ = true;
  std::uint64_t number_ = 0;  ///< Of pictures that each head showed.
  std::function<void(healing::ShowMoment*)> teller_;
  double cpu_s_ = 0.0;
};

/// A bump of one of six degrees, or of all, whose pixels move by about so many.
[[nodiscard]] calibration::PoseStep drawn_bump(simulated::RandomStream* draws);

}  // namespace cyclorama
