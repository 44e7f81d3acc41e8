// SPDX-License-Identifier: Apache-2.0
/// Learns from measured frames how long a frame takes.
#pragma once

namespace cyclorama::governor {

/// Measured cost and time of one frame.
struct MeasuredFrame {
  /// Cost of the picture in the unit of ParetoPoint::cost, times its displayed megapixels.
  double work = 0.0;
  double ms = 0.0;  ///< Time for which the frame occupied the farm, network included.
  /// Thread time that the busiest node spent on tracing the frame, divided by the node's threads. 0: not measured.
  double rays_ms = 0.0;
};

/// Predicts a frame's time as fixed + rate * work:
///
///   rays = cost_rate * work      cost_rate: how expensive the scene is at present, from the nodes' thread times
///   time = fixed + slope * rays  fixed: network, encoder, waiting; slope: near 1, larger if threads wait for cores
///
/// Without measured thread times, cost_rate is 1 and the slope is the whole rate.
///
/// The cost rate moves by a fifth of the logarithm of each measurement's deviation. An increase by a quarter is adopted
/// at once, a decrease by a fifth if two frames in a row show it.
///
/// (fixed, slope) is the state of a Kalman filter with a random walk: recursive least squares that forgets, with a
/// prior. It starts with a slope of 1 or, without thread times, with no fixed time. After each step it is projected
/// onto fixed >= 0 and slope > 0. While all frames have the same work, only the prior determines how their time is
/// divided between the two, and sd_ms() increases with the distance from the measured work.
///
/// A single frame that deviates by more than 3.5 standard deviations is ignored. A cumulative sum test detects jumps,
/// such as two of these frames in a row. A jump widens the variance, mainly that of the slope, so that the filter
/// follows at once. The noise is estimated from the differences between successive frames, in which an error of the
/// model cancels.
///
/// Sources: L. Ljung and T. Soderstrom, Theory and Practice of Recursive Identification, MIT Press 1983 (recursive
/// least squares as a Kalman filter); D. Simon and T. L. Chia, Kalman filtering with state equality constraints, IEEE
/// Transactions on Aerospace and Electronic Systems 38, 2002 (the projection); E. S. Page, Continuous inspection
/// schemes, Biometrika 41, 1954 (the cumulative sum test). Pure; thread-bound.
class FrameTimeModel {
 public:
  /// Ignores invalid frames: times or works that are NaN, infinite or not above 0.
  void add(const MeasuredFrame& frame);

  [[nodiscard]] bool is_known() const { return known_; }
  /// Predicts a frame's time in ms. Precondition of this and the following functions: is_known().
  [[nodiscard]] double ms_of(double work) const;
  /// Returns the standard deviation of the prediction ms_of(work), without the noise of frames.
  [[nodiscard]] double sd_ms(double work) const;
  /// Returns the work that is predicted to take `ms`; 0 if the fixed time alone takes as long.
  [[nodiscard]] double work_within(double ms) const;
  /// Returns a work that takes at most `ms` even if the division into fixed and slope is wrong. It is the larger of
  /// two: the last frame's work times `ms` over its predicted time, which is safe because fixed >= 0; and the work
  /// whose prediction plus twice its sd_ms() is `ms`. At most five times the last frame's work.
  [[nodiscard]] double work_surely_within(double ms) const;
  /// Returns the noise of frames as a standard deviation relative to their predictions.
  [[nodiscard]] double noise() const { return noise_; }
  /// Returns the work of the last frame.
  [[nodiscard]] double last_work() const { return last_work_; }
  [[nodiscard]] double fixed_ms() const { return fixed_; }

 private:
  void start(const MeasuredFrame& frame, double rays);
  /// Begins to use thread times at the first frame that has any.
  void begin_rays(double rate);
  /// Updates the noise. `change` is the change of the deviation from the prediction between successive frames of equal
  /// work.
  void learn_noise(double change);
  void learn_cost(double rate);
  /// Updates fixed and slope from a frame whose busiest node took the time `rays`.
  void learn_split(double rays, double ms);
  /// Limits the variance to that of the prior, so that the random walk does not forget more than the prior while
  /// nothing varies.
  void limit(double expected);
  void correct(double rays, double innovation, double variance);
  void project(double rays);

  bool known_ = false;
  bool has_rays_ = false;
  double cost_rate_ = 1.0;
  double fixed_ = 0.0;
  double slope_ = 1.0;
  struct Covariance {
    double fixed = 0.0;  ///< Variance of fixed_.
    double slope = 0.0;  ///< Variance of slope_.
    double both = 0.0;
  };
  Covariance covariance_;  ///< Covariance of fixed_ and slope_.
  double noise_ = 0.08;
  double last_work_ = 0.0;
  double last_deviation_ = 0.0;  ///< Logarithm of the last frame's time over its prediction.
  double late_ = 0.0;            ///< Cumulative sums of the test for jumps, in standard deviations.
  double early_ = 0.0;
  bool was_cheap_ = false;  ///< True if the last frame's cost rate was far below the learnt one.
};

}  // namespace cyclorama::governor
