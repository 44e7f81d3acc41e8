// SPDX-License-Identifier: Apache-2.0
/// Rendered pictures of hands with wands, with their true poses, for the tracker's figures.
#pragma once

#include <array>
#include <vector>

#include "common/wand/folded_card.h"
#include "drivers/simulated/camera/sensor.h"
#include "drivers/simulated/camera/simulated_camera.h"
#include "drivers/simulated/camera/tag_painter.h"

namespace cyclorama {

using HandPose = RigidTransform<frame::Camera, frame::Tag>;

inline constexpr double kDegree = 0.017453292519943295;
/// 640x480, focal length 600 px: the conditions of the stated goals.
inline const Pinhole kBenchLens{640, 480, 600.0, 320.0, 240.0};

/// Returns a point of the unit cube from Halton's sequence (Halton 1960), leaped (Kocis and Whiten, "Computational
/// Investigations of Low-Discrepancy Sequences", 1997), since its high dimensions are correlated at first.
inline double halton(std::uint64_t index, std::size_t dimension) {
  constexpr std::array<unsigned, 18> kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61};
  constexpr std::uint64_t kLeap = 409;
  const unsigned base = kPrimes[dimension];
  double value = 0.0;
  double digit = 1.0 / base;
  for (std::uint64_t i = (index + 1) * kLeap; i > 0; i /= base, digit /= base) {
    value += digit * static_cast<double>(i % base);
  }
  return value;
}

/// One short sequence: a hand in uniform motion, with its own lighting and possibly another visitor.
struct HandScene {
  Eigen::Vector3d position_m, speed_m_s;
  double yaw_rad, pitch_rad, roll_rad, yaw_rate, pitch_rate;
  double noise_grey, brightness, exposure_s;
  bool is_covered, has_company;
  std::size_t covered_corner;
  unsigned backdrop;

  static constexpr double kPicturesPerSecond = 30.0;

  /// Yaws are sampled from -max_yaw_deg to max_yaw_deg.
  static HandScene sampled(std::uint64_t index, double distance_m, double max_yaw_deg) {
    std::size_t dimension = 0;
    const auto between = [&](double min, double max) { return min + (max - min) * halton(index, dimension++); };
    HandScene scene{};
    const double side = 0.2 * std::min(distance_m, 1.5);
    scene.position_m = {between(-side, side), between(-0.6 * side, 0.6 * side), distance_m};
    scene.yaw_rad = between(-max_yaw_deg, max_yaw_deg) * kDegree;
    scene.pitch_rad = between(-12.0, 22.0) * kDegree;
    scene.roll_rad = between(-12.0, 12.0) * kDegree;
    scene.speed_m_s = {between(-0.25, 0.25), between(-0.15, 0.15), 0.0};
    scene.yaw_rate = between(-30.0, 30.0) * kDegree;
    scene.pitch_rate = between(-15.0, 15.0) * kDegree;
    scene.noise_grey = between(1.0, 4.0);
    scene.brightness = between(0.35, 1.1);
    scene.exposure_s = between(0.002, 0.008);
    scene.is_covered = between(0.0, 1.0) < 0.25;
    scene.covered_corner = static_cast<std::size_t>(between(0.0, 11.999));
    scene.has_company = between(0.0, 1.0) < 0.25;
    scene.backdrop = static_cast<unsigned>(between(0.0, 3.999));
    return scene;
  }

  [[nodiscard]] HandPose pose_at(double time_s) const {
    const simulated::KeyPose key{0.0, position_m + time_s * speed_m_s, yaw_rad + time_s * yaw_rate,
                                 pitch_rad + time_s * pitch_rate, roll_rad};
    return {simulated::rotation_of(key), key.position_m};
  }
  /// Reference for a measured pose: the middle of the exposure.
  [[nodiscard]] HandPose truth(int picture) const { return pose_at(picture / kPicturesPerSecond + 0.5 * exposure_s); }
};

/// Renders scenes. Reentrant.
class HandStudio {
 public:
  explicit HandStudio(Wand wand = standard_wand(0), const Pinhole& lens = kBenchLens)
      : wand_(std::move(wand)), lens_(lens), painter_(wand_), company_(standard_wand(1)) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      simulated::Simulation simulation;
      simulation.lens = lens;
      simulation.seed = seed;
      simulation.noise_grey = 0.0;
      simulation.path = *simulated::HandPath::make({simulated::KeyPose{0.0, {0, 0, -1}, 0, 0, 0}}, std::nullopt);
      const GreyImage drawn = simulated::SimulatedView(simulation).picture(0);
      Image<float, 1> light(drawn.width(), drawn.height());
      std::copy(drawn.data().begin(), drawn.data().end(), light.data().begin());
      backdrops_.push_back(std::move(light));
    }
    for (int level = 0; level <= kNoiseLevels; ++level) {
      sensors_.emplace_back(kMaxNoise * level / kNoiseLevels, static_cast<std::uint32_t>(level));
    }
  }

  [[nodiscard]] int wand_id() const { return wand_.id(); }

  [[nodiscard]] GreyImage picture(const HandScene& scene, int picture, std::uint64_t number) const {
    Image<float, 1> light = backdrops_[scene.backdrop];
    const double opens_s = picture / HandScene::kPicturesPerSecond;
    if (scene.has_company) {
      HandPose other = scene.pose_at(-opens_s);
      const Eigen::Vector3d position = other.translation();
      company_.paint(
          {{other.rotation(),
            {position.x() > 0 ? -0.3 * position.z() : 0.3 * position.z(), -position.y(), 1.3 * position.z()}}},
          lens_, &light);
    }
    std::vector<HandPose> moments;
    for (int i = 0; i < 4; ++i) moments.push_back(scene.pose_at(opens_s + scene.exposure_s * (i + 0.5) / 4));
    painter_.paint(moments, lens_, &light);
    if (scene.is_covered) cover(scene, scene.truth(picture), &light);
    const auto level = static_cast<std::size_t>(std::lround(scene.noise_grey / kMaxNoise * kNoiseLevels));
    return sensors_[std::min(level, sensors_.size() - 1)].expose(light, scene.brightness, number);
  }
  [[nodiscard]] const Pinhole& lens() const { return lens_; }

 private:
  static constexpr int kNoiseLevels = 12;
  static constexpr double kMaxNoise = 6.0;

  /// Draws a fingertip, 18 mm across, on a corner of a tag.
  void cover(const HandScene& scene, const HandPose& pose, Image<float, 1>* light) const {
    const WandTag& tag = wand_.tags[scene.covered_corner / 4 % wand_.tags.size()];
    const Eigen::Vector3d tip = (pose * Point<frame::Tag>{tag.corners[scene.covered_corner % 4]}).xyz;
    const auto middle = lens_.pixel_of(tip);
    if (!middle) return;
    const double radius = 0.009 * lens_.focal_px / tip.z();
    for (int v = std::max(0, static_cast<int>(middle->y() - radius - 1));
         v < std::min(light->height(), static_cast<int>(middle->y() + radius + 2)); ++v) {
      for (int u = std::max(0, static_cast<int>(middle->x() - radius - 1));
           u < std::min(light->width(), static_cast<int>(middle->x() + radius + 2)); ++u) {
        const double away = (Eigen::Vector2d(u + 0.5, v + 0.5) - *middle).norm();
        const auto share = static_cast<float>(std::clamp(radius - away + 0.5, 0.0, 1.0));
        float* const grey = light->at(u, v);
        *grey += share * (140.0f - *grey);
      }
    }
  }

  Wand wand_;
  Pinhole lens_;
  simulated::TagPainter painter_;
  simulated::TagPainter company_;
  std::vector<Image<float, 1>> backdrops_;
  std::vector<simulated::Sensor> sensors_;
};

}  // namespace cyclorama
