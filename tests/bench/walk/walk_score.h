// SPDX-License-Identifier: Apache-2.0
/// Judges what a wall showed at each refresh of a walk against the truth.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Means over the refreshes from the first frame on.
struct WalkFigures {
  double psnr_db = 0.0;  ///< From the mean squared error over all refreshes.
  double ssim = 0.0;     ///< Measured at every eighth refresh, like flip.
  double flip = 0.0;
  double worst_psnr_db = 1e9;
  double switch_share = 0.0;  ///< At a new frame: error of the change between two refreshes over the true change; RMS.
  double step_share = 0.0;    ///< The same at all other refreshes.
  double motion = 0.0;        ///< True change from one refresh to the next, in codes; RMS.
  /// Change when a frame replaces another though the visitor's eye stays: noise and other errors that differ between
  /// frames, in codes; RMS over all refreshes, so that few frames a second flicker less than many.
  double flicker = 0.0;
  double holes = 0.0;        ///< Upper bound: area of torn quads in the pictures, over their area.
  double depth_share = 0.0;  ///< Bytes of depth over those of JPEG, of the first frame; 0 without a mesh.
  int frames = 0;
  double cpu_s_per_frame = 0.0;  ///< Thread time of rendering.
};

class WalkScore {
 public:
  /// Adds a refresh; returns true if it is the worst so far. Errors: shown_error()'s.
  Result<bool> add(RgbImage shown, const RgbImage& truth, bool is_first_of_frame);
  /// Adds what the old and the new frame show for the same eye.
  void add_switch(const RgbImage& by_old, const RgbImage& by_new);
  [[nodiscard]] int refreshes() const { return refreshes_; }
  /// Sets the figures that compare pictures. Precondition: refreshes() > 0.
  void write_to(WalkFigures* figures) const;

 private:
  /// Squares of the true change from one refresh to the next, and of what the shown change differs by.
  struct Change {
    double truth = 0.0;
    double error = 0.0;
    double values = 0.0;
    [[nodiscard]] double share() const;
  };
  void add_change(const RgbImage& shown, const RgbImage& truth, Change* change) const;

  RgbImage shown_before_;
  RgbImage truth_before_;
  int refreshes_ = 0;
  int judged_ = 0;
  double squares_ = 0.0;
  double flicker_squares_ = 0.0;
  double worst_psnr_db_ = 1e9;
  double ssim_ = 0.0;
  double flip_ = 0.0;
  Change at_switch_;
  Change between_;
};

}  // namespace cyclorama
