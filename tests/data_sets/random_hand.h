// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "kiosk/tour/navigation/visit_walk.h"

namespace cyclorama {

/// A visitor's hand, as a tracker reports it: moved to and fro, still for a while, shaking, hidden, thrown, with
/// occasionally wrong numbers and time stamps. The same for the same seed.
class RandomHand {
 public:
  struct Habits {
    double shake_m = 0.002;
    double shake_rad = 0.01;
    double wild = 0.6;   ///< Rate per second of jumps: a thrown wand, another tag, or invalid numbers.
    double lost = 0.15;  ///< Rate per second of disappearances, each for up to three seconds.
    bool odd_stamps = false;
  };
  RandomHand(std::uint64_t seed, const Habits& habits) : random_(seed), habits_(habits) {}

  /// Returns the observation of a picture taken `step` after the last one.
  tour::PoseSeen next(Duration step) {
    const double seconds = to_seconds(step);
    ++sequence_;
    shutter_ns_ += std::chrono::duration_cast<std::chrono::nanoseconds>(step).count();
    if (chance(habits_.lost * seconds)) lost_s_ = 3.0 * uniform();
    if (chance(0.5 * seconds)) aim_ = {normal(0.4), 1.0 + normal(0.4), normal(0.7)};
    for (std::size_t i = 0; i < aim_.size(); ++i) at_[i] += (aim_[i] - at_[i]) * std::min(1.0, 3.0 * seconds);
    lost_s_ -= seconds;
    tour::PoseSeen seen;
    seen.tracker = chance(0.01) ? 2 : 1;
    seen.sequence = sequence_;
    seen.shutter_ns = habits_.odd_stamps ? odd_stamp() : shutter_ns_;
    seen.found = lost_s_ <= 0.0;
    const bool wild = chance(habits_.wild * seconds);
    const double yaw = (wild ? normal(3.0) : at_[2]) + normal(habits_.shake_rad);
    seen.position_m = {(wild ? normal(3.0) : at_[0]) + normal(habits_.shake_m), normal(habits_.shake_m),
                       (wild ? normal(5.0) : at_[1]) + normal(habits_.shake_m)};
    seen.rotation = {std::cos(0.5 * yaw), 0.0, std::sin(0.5 * yaw), 0.0};
    if (wild && chance(0.1)) seen.position_m[2] = std::nan("");
    if (wild && chance(0.1)) seen.rotation[1] = 1e300;
    return seen;
  }
  bool chance(double part) { return uniform() < part; }
  double uniform() { return std::uniform_real_distribution<double>()(random_); }
  double normal(double deviation) { return deviation * std::normal_distribution<double>()(random_); }

 private:
  /// Returns a stamp that is repeated, early, an hour ahead, or negative.
  std::int64_t odd_stamp() {
    const double kind = uniform();
    if (kind < 0.02) return shutter_ns_ + 3'600'000'000'000;
    if (kind < 0.04) return -shutter_ns_;
    if (kind < 0.10) return shutter_ns_ - 40'000'000;
    if (kind < 0.16) return last_odd_;
    return last_odd_ = shutter_ns_;
  }
  std::mt19937_64 random_;
  Habits habits_;
  std::array<double, 3> aim_{0.0, 1.0, 0.0};  ///< Camera x, distance, yaw.
  std::array<double, 3> at_{0.0, 1.0, 0.0};
  double lost_s_ = 0.0;
  std::uint64_t sequence_ = 0;
  std::int64_t shutter_ns_ = 1'000'000'000;
  std::int64_t last_odd_ = 0;
};

}  // namespace cyclorama
