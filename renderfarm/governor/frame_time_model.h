// SPDX-License-Identifier: Apache-2.0
/// Learns on line how long a frame takes, from the frames before it.
#pragma once

namespace cyclorama::governor {

/// Measured cost and time of one frame.
struct MeasuredFrame {
  /// Cost of the picture in the unit of ParetoPoint::cost, times its displayed megapixels.
  double work = 0.0;
  double ms = 0.0;  ///< Time for which it occupied the farm, network included.
  /// Thread time that the busiest node spent on tracing it, over the node's threads. 0: not measured.
  double rays_ms = 0.0;
};

/// Predicts a frame's time as fixed + rate * work:
///
///   rays = cost_rate * work      cost_rate: how expensive the scene is at present; follows the nodes' thread times
///   time = fixed + slope * rays  fixed: network, encoder, waiting; slope: near 1, larger where threads wait for processors
///
/// Where no thread times are measured, cost_rate is 1 and the slope is the whole rate.
///
/// The cost rate moves by a fifth of each measurement's logarithm; an increase by a quarter is adopted at once, a
/// decrease by a fifth when two frames in a row show it.
///
/// (fixed, slope) is the state of a Kalman filter whose state is a random walk: recursive least squares that forgets,
/// with a prior. It starts from a slope of 1, or without thread times from no fixed time, and is projected on fixed >=
/// 0 and slope > 0 after each step. As long as all frames had the same work, only the prior splits their time into the
/// two, and sd_ms() grows with the distance from the measured work.
///
/// One frame that is more than 3.5 standard deviations off is left out. A cumulative sum test finds jumps, such as two of
/// these in a row; a jump widens the variance, mainly the slope's, so that the filter follows at once. The noise is that
/// of successive frames' differences, in which an error of the model cancels.
///
/// Sources: L. Ljung and T. Soderstrom, Theory and Practice of Recursive Identification, MIT Press 1983 (recursive least
/// squares as a Kalman filter); D. Simon and T. L. Chia, Kalman filtering with state equality constraints, IEEE
/// Transactions on Aerospace and Electronic Systems 38, 2002 (the projection); E. S. Page, Continuous inspection schemes,
/// Biometrika 41, 1954 (the cumulative sum test). Pure; thread-bound.
class FrameTimeModel {
 public:
  /// Ignores invalid frames: times or works that are NaN, infinite or not above 0.
  void add(const MeasuredFrame& frame);

  [[nodiscard]] bool is_known() const { return known_; }
  /// Predicts a frame's time in ms. Precondition of this and the following functions: is_known().
  [[nodiscard]] double ms_of(double work) const;
  /// Returns the standard deviation of that prediction, without the frames' own noise.
  [[nodiscard]] double sd_ms(double work) const;
  /// Returns the work that is predicted to take `ms`; 0 if the fixed part takes it all.
  [[nodiscard]] double work_within(double ms) const;
  /// Returns a work that takes at most `ms` even if the split of the time is wrong: fixed >= 0, so no more than the last
  /// frame's work times `ms` over its predicted time, or the work whose prediction plus twice its sd_ms() is `ms`. At most
  /// five times the last frame's work.
  [[nodiscard]] double work_surely_within(double ms) const;
  /// Returns the noise of frames, as a standard deviation relative to their predictions.
  [[nodiscard]] double noise() const { return noise_; }
  /// Returns the work of the last frame.
  [[nodiscard]] double last_work() const { return last_work_; }
  [[nodiscard]] double fixed_ms() const { return fixed_; }

 private:
  void start(const MeasuredFrame& frame, double rays);
  /// Begins to use thread times, at the first frame that has any.
  void begin_rays(double rate);
  /// `change`: by how much the deviation from the prediction changed between two successive frames of the same work.
  void learn_noise(double change);
  void learn_cost(double rate);
  /// Updates fixed and slope from a frame whose busiest node took `rays`.
  void learn_split(double rays, double ms);
  /// Limits the variance to that of the prior, so that the random walk does not forget more than that while nothing
  /// varies.
  void limit(double expected);
  void correct(double rays, double innovation, double variance);
  void project(double rays);

  bool known_ = false;
  bool has_rays_ = false;
  double cost_rate_ = 1.0;
  double fixed_ = 0.0;
  double slope_ = 1.0;
  struct Covariance {
    double fixed = 0.0;  ///< Variance.
    double slope = 0.0;  ///< Variance.
    double both = 0.0;
  };
  Covariance covariance_;  ///< Covariance of fixed_ and slope_.
  double noise_ = 0.08;
  double last_work_ = 0.0;
  double last_deviation_ = 0.0;  ///< Logarithm of the last frame's time over its prediction.
  double late_ = 0.0;            ///< Cumulative sums of the test for jumps, in standard deviations.
  double early_ = 0.0;
  bool was_cheap_ = false;  ///< The last frame's cost rate was far below the learnt one.
};

}  // namespace cyclorama::governor
