// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/camera/hand_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama::simulated {
namespace {

using Eigen::Vector3d;

/// Minimum time between key poses; less is refused as a mistake.
constexpr double kMinStepS = 1e-3;

KeyPose key(double time_s, const Vector3d& position_m, double yaw_deg, double pitch_deg, double roll_deg) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  return {time_s, position_m, yaw_deg * kDegree, pitch_deg * kDegree, roll_deg * kDegree};
}

bool is_finite(const KeyPose& pose) {
  return pose.position_m.allFinite() && std::isfinite(pose.time_s + pose.yaw_rad + pose.pitch_rad + pose.roll_rad);
}

}  // namespace

Eigen::Quaterniond rotation_of(const KeyPose& key) {
  return Eigen::AngleAxisd(key.yaw_rad, Vector3d::UnitY()) * Eigen::AngleAxisd(-key.pitch_rad, Vector3d::UnitX()) *
         Eigen::AngleAxisd(key.roll_rad, Vector3d::UnitZ());
}

Result<HandPath> HandPath::make(std::vector<KeyPose> keys, std::optional<double> loop_s) {
  const auto refuse = [](const std::string& what) { return Error(ErrorCode::kInvalidArgument, what); };
  if (keys.empty()) return refuse("a path needs at least one key pose");
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!is_finite(keys[i])) return refuse(fmt::format("key pose {} is not finite", i));
    if (i > 0 && !(keys[i].time_s - keys[i - 1].time_s >= kMinStepS)) {
      return refuse(fmt::format("key pose {} at {} s does not come after {} s", i, keys[i].time_s, keys[i - 1].time_s));
    }
  }
  if (loop_s) {
    if (!(*loop_s - keys.back().time_s >= kMinStepS) || !std::isfinite(*loop_s)) {
      return refuse(
          fmt::format("the loop ends at {} s, before the last key pose at {} s", *loop_s, keys.back().time_s));
    }
    keys.push_back(keys.front());
    keys.back().time_s = *loop_s;
  }
  return HandPath(std::move(keys), loop_s.has_value());
}

HandPath HandPath::demo() {
  // At rest the tag is 1 m away, where the tour's settings give speed 0, a little below the camera, and tilted back as
  // people hold things.
  const std::vector<KeyPose> keys{
      key(0.0, {0.00, 0.05, 1.00}, 0, 8, 0),      key(1.0, {0.00, 0.05, 1.00}, 0, 8, 1),
      key(2.2, {0.00, 0.04, 0.74}, 2, 10, 0),     key(5.0, {0.02, 0.04, 0.72}, -2, 10, -1),
      key(6.0, {0.02, 0.05, 0.98}, 18, 8, 1),     key(9.0, {0.02, 0.05, 1.00}, 26, 8, 2),
      key(10.4, {0.01, 0.05, 0.75}, 3, 9, 0),     key(13.0, {0.00, 0.05, 0.73}, 2, 9, 0),
      key(14.2, {-0.02, 0.05, 0.98}, -21, 8, -2), key(18.2, {-0.02, 0.05, 1.01}, -27, 8, -2),
      key(19.6, {0.00, 0.05, 1.00}, -1, 8, 0),    key(20.8, {-0.24, 0.05, 1.00}, 0, 8, 0),
      key(22.8, {-0.23, 0.05, 0.99}, 1, 8, 1),    key(24.0, {0.00, 0.05, 1.24}, 0, 8, 0),
      key(26.4, {0.01, 0.05, 1.26}, 2, 8, 0),
  };
  Result<HandPath> path = make(keys, 28.0);
  CHECK(path.has_value());
  return *std::move(path);
}

HandPath::Values HandPath::values_of(const KeyPose& key) {
  Values values;
  values << key.position_m, key.yaw_rad, key.pitch_rad, key.roll_rad;
  return values;
}

HandPath::Values HandPath::slope_of(std::size_t piece) const {
  return (values_of(keys_[piece + 1]) - values_of(keys_[piece])) / (keys_[piece + 1].time_s - keys_[piece].time_s);
}

HandPath::Values HandPath::slope_at(std::size_t key) const {
  const std::size_t pieces = keys_.size() - 1;
  const bool is_end = key == 0 || key == pieces;
  if (is_end && !loops_) return Values::Zero();
  const std::size_t before = is_end ? pieces - 1 : key - 1;
  const std::size_t after = is_end ? 0 : key;
  const double step_before = keys_[before + 1].time_s - keys_[before].time_s;
  const double step_after = keys_[after + 1].time_s - keys_[after].time_s;
  const double alpha = (step_before + 2.0 * step_after) / (3.0 * (step_before + step_after));
  const Values a = slope_of(before);
  const Values b = slope_of(after);
  Values slope = Values::Zero();
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    // At a turning point the slope is zero; elsewhere it is a weighted harmonic mean, Fritsch and Butland's G.
    if (a[i] * b[i] > 0.0) slope[i] = a[i] * b[i] / (alpha * b[i] + (1.0 - alpha) * a[i]);
  }
  return slope;
}

RigidTransform<frame::Camera, frame::Tag> HandPath::at(double time_s) const {
  const double first = keys_.front().time_s;
  double t = std::isfinite(time_s) ? time_s : first;
  if (loops_) {
    t = first + std::fmod(t - first, duration_s());
    if (t < first) t += duration_s();
  }
  std::size_t piece = 0;
  while (piece + 2 < keys_.size() && t >= keys_[piece + 1].time_s) ++piece;
  Values values = values_of(keys_.front());
  if (keys_.size() > 1) {
    const KeyPose& from = keys_[piece];
    const KeyPose& to = keys_[piece + 1];
    const double step = to.time_s - from.time_s;
    const double s = std::min(std::max((t - from.time_s) / step, 0.0), 1.0);
    const double s2 = s * s;
    const double s3 = s2 * s;
    values = (2 * s3 - 3 * s2 + 1) * values_of(from) + (s3 - 2 * s2 + s) * step * slope_at(piece) +
             (3 * s2 - 2 * s3) * values_of(to) + (s3 - s2) * step * slope_at(piece + 1);
  }
  const KeyPose pose{t, values.head<3>(), values[3], values[4], values[5]};
  return {rotation_of(pose), pose.position_m};
}

}  // namespace cyclorama::simulated
