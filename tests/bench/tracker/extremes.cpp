// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <limits>
#include <random>

#include "tests/bench/tracker/pose_errors.h"
#include "tests/bench/tracker/tracker_bench.h"

namespace cyclorama {
namespace {

using Eigen::Vector3d;

/// Counts cases and failures.
class Cases {
 public:
  explicit Cases(const char* name) : name_(name) {}
  void expect(bool well) {
    ++cases_;
    failures_ += well ? 0 : 1;
  }
  void close(nlohmann::json* result) const {
    std::printf("%-52s %9d cases, %d failures\n", name_, cases_, failures_);
    (*result)["cases"] = (*result)["cases"].get<int>() + cases_;
    (*result)["failures"] = (*result)["failures"].get<int>() + failures_;
  }

 private:
  const char* name_;
  int cases_ = 0;
  int failures_ = 0;
};

bool is_finite(const tracker::T_CameraTag& pose) {
  return pose.translation().allFinite() && std::abs(pose.rotation().norm() - 1.0) < 1e-6;
}
/// Returns true if nothing was found or all numbers are finite.
bool is_sound(const tracker::TrackingResult& result) {
  if (!result.tag) return true;
  return is_finite(result.tag->T_camera_tag) && is_finite(result.tag->chosen.pose.T_camera_tag) &&
         result.tag->covariance.allFinite() && result.tag->covariance.diagonal().minCoeff() >= 0.0;
}

tracker::T_CameraTag pose_of(double yaw_deg, double pitch_deg, double roll_deg, const Vector3d& true_position) {
  return {simulated::rotation_of({0.0, {}, yaw_deg * kDegree, pitch_deg * kDegree, roll_deg * kDegree}), true_position};
}

/// Projects the tags that face the camera; corners may be outside the picture, which no detector returns.
std::vector<tags::TagDetection> project(const Wand& wand, const tracker::T_CameraTag& pose, const Pinhole& lens,
                                        double noise_px, std::mt19937* random) {
  std::normal_distribution<double> normal(0.0, noise_px);
  std::vector<tags::TagDetection> seen;
  for (const WandTag& tag : wand.tags) {
    const auto face = face_of(tag);
    const Vector3d into = pose.rotation() * (face.rotation() * Vector3d::UnitZ());
    if (into.dot((pose * Point<frame::Tag>{face.translation()}).xyz) <= 0.0) continue;
    tags::TagDetection detection{tag.id, 0, 80.0, {}};
    bool in_front = true;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto pixel = lens.pixel_of((pose * Point<frame::Tag>{tag.corners[i]}).xyz);
      in_front = in_front && pixel.has_value();
      if (pixel) detection.corners[i] = *pixel + Eigen::Vector2d(normal(*random), normal(*random));
      detection.covariance[i] = std::max(1e-6, noise_px * noise_px) * Eigen::Matrix2d::Identity();
    }
    if (in_front) seen.push_back(detection);
  }
  return seen;
}

void focal_lengths_sizes_and_grazing(nlohmann::json* result) {
  std::mt19937 random(1);
  Cases cases("focal 200 to 5000 px, 8 px to full frame, to 85 deg");
  Cases lost("  of these without noise: the pose is the true one");
  for (const Wand& wand : {standard_wand(0), flat_tag(0, 0.12)}) {
    const double size = wand.tags[0].size_m;
    for (const double focal : {200.0, 600.0, 2000.0, 5000.0}) {
      for (const double side_px : {8.0, 20.0, 100.0, 400.0}) {
        const Pinhole lens{640, 480, focal, 320.0, 240.0};
        for (double yaw = -85.0; yaw <= 85.0; yaw += 5.0) {
          for (const double roll : {0.0, 45.0, 180.0}) {
            const tracker::T_CameraTag pose = pose_of(yaw, 8.0, roll, {0, 0, focal * size / side_px + 0.08});
            for (const double noise : {0.0, 0.05, 1.0}) {
              const auto seen = project(wand, pose, lens, noise, &random);
              tracker::TrackingSettings settings;
              settings.patterns.wands = {wand};
              const tracker::TrackingResult r = tracker::track(settings, {}, seen, lens, after(0));
              cases.expect(is_sound(r));
              if (noise > 0.0 || wand.tags.size() == 1 || seen.empty()) continue;
              lost.expect(r.tag && r.tag->chosen.pose.T_camera_tag.rotation().angularDistance(pose.rotation()) < 0.02);
            }
          }
        }
      }
    }
  }
  cases.close(result);
  lost.close(result);
}

void pictures(bool quick, nlohmann::json* result) {
  Cases cases("rendered: 8 px to full frame, any lens, upside down");
  for (const double focal : {200.0, 600.0, 5000.0}) {
    const Pinhole lens{640, 480, focal, 320.0, 240.0};
    const HandStudio studio(standard_wand(0), lens);
    for (const double side_px : {8.0, 16.0, 60.0, 150.0, 460.0}) {
      for (double yaw = -85.0; yaw <= 85.0; yaw += quick ? 42.5 : 8.5) {
        HandScene scene = HandScene::sampled(7, 0.07 * focal / side_px, 1.0);
        scene.position_m.head<2>().setZero();
        scene.is_covered = scene.has_company = false;
        scene.yaw_rad = yaw * kDegree;
        scene.roll_rad = 3.141592653589793;  // Upside down.
        auto search = tags::TagSearch::create({});
        tracker::TrackingState state;
        for (int i = 0; i < 3; ++i) {
          const auto found = search->search(studio.picture(scene, i, static_cast<std::uint64_t>(i)));
          cases.expect(found.has_value());
          const tracker::TrackingResult r = tracker::track({}, state, *found, lens, after(i / 30.0));
          state = r.state;
          cases.expect(is_sound(r));
          const bool easy = side_px > 50.0 && side_px < 100.0 && std::abs(yaw) < 50.0;
          if (!easy) continue;
          cases.expect(r.tag &&
                       r.tag->chosen.pose.T_camera_tag.rotation().angularDistance(scene.truth(i).rotation()) < 0.05);
        }
      }
    }
  }
  cases.close(result);
}

void half_an_hour(bool quick, nlohmann::json* result) {
  Cases cases("30 minutes of filter at 1000 Hz");
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0.0, 1e-3);
  std::optional<tracker::FilteredPosition> position;
  std::optional<tracker::FilteredRotation> rotation;
  const int steps = (quick ? 1 : 30) * 60 * 1000;
  const tracker::TrackingSettings settings;
  for (int i = 0; i < steps; ++i) {
    const double t = 1e-3 * i;
    const Vector3d true_position(0.3 * std::sin(2.0 * t) + normal(random), 0.02, 1.0 + 0.2 * std::cos(0.7 * t));
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(3.0 * std::sin(t) + normal(random), Vector3d::UnitY()));
    position = tracker::filter(settings.position, position, true_position, after(t));
    rotation = tracker::filter(settings.rotation, rotation, turn, after(t));
    const bool well = position && rotation && (position->value - true_position).norm() < 0.1 &&
                      rotation->value.angularDistance(turn) < 0.5 && std::abs(rotation->value.norm() - 1.0) < 1e-9;
    cases.expect(well);
  }
  cases.close(result);
}

void time_stamps(bool quick, nlohmann::json* result) {
  Cases cases("time stamps that repeat, jump and go backwards");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  const Wand wand = standard_wand(0);
  tracker::TrackingState state;
  double t = 0.0;
  for (int i = 0; i < (quick ? 5'000 : 50'000); ++i) {
    const double what = any(random);
    if (what < 0.6) t += 0.033;
    if (what > 0.7 && what < 0.8) t -= 0.2 * any(random);
    if (what > 0.9) t += 1000.0 * (any(random) - 0.5);
    if (what > 0.999) t = 0.0;
    const tracker::T_CameraTag pose =
        pose_of(50.0 * std::sin(0.01 * i), 10.0, 0.0, {0.1 * std::sin(0.02 * i), 0.0, 1.0});
    auto seen = project(wand, pose, kBenchLens, 0.05, &random);
    if (any(random) < 0.1) seen.clear();
    const tracker::TrackingResult r = tracker::track({}, state, seen, kBenchLens, after(t));
    state = r.state;
    cases.expect(is_sound(r) && (!r.tag || r.tag->T_camera_tag.translation().norm() < 3.0));
  }
  const Wand flat = flat_tag(0, 0.12);
  for (const TimePoint at : {TimePoint::min(), TimePoint(), TimePoint::max()}) {
    tracker::TrackingSettings settings;
    settings.patterns.wands = {flat};
    const auto seen = project(flat, pose_of(5, 5, 0, {0, 0, 1}), kBenchLens, 0.05, &random);
    cases.expect(is_sound(tracker::track(settings, {}, seen, kBenchLens, at)));
  }
  cases.close(result);
}

void thrown(bool quick, nlohmann::json* result) {
  Cases cases("a wand that is thrown: 10 m/s, three turns per second");
  const HandStudio studio;
  for (int thrown = 0; thrown < (quick ? 4 : 40); ++thrown) {
    HandScene scene = HandScene::sampled(static_cast<std::uint64_t>(thrown), 1.0, 60.0);
    scene.speed_m_s = {thrown % 2 == 0 ? 4.0 : -4.0, -3.0, 8.0};
    scene.yaw_rate = 19.0;
    scene.pitch_rate = 8.0;
    auto search = tags::TagSearch::create({});
    tracker::TrackingState state;
    for (int i = 0; i < 30; ++i) {
      const auto found = search->search(studio.picture(scene, i, static_cast<std::uint64_t>(i)));
      cases.expect(found.has_value());
      const tracker::TrackingResult r = tracker::track({}, state, *found, studio.lens(), after(i / 30.0));
      state = r.state;
      cases.expect(is_sound(r));
    }
  }
  cases.close(result);
}

}  // namespace

nlohmann::json measure_extremes(bool quick) {
  nlohmann::json result = {{"cases", 0}, {"failures", 0}};
  focal_lengths_sizes_and_grazing(&result);
  pictures(quick, &result);
  half_an_hour(quick, &result);
  time_stamps(quick, &result);
  thrown(quick, &result);
  return result;
}

}  // namespace cyclorama
