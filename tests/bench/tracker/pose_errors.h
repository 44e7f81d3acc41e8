// SPDX-License-Identifier: Apache-2.0
/// Runs rendered sequences through the tracker's own search and pose estimation, and records the errors.
#pragma once

#include "appliance/tags/tag_search.h"
#include "appliance/tracker/overlay.h"
#include "appliance/tracker/tag_tracking.h"
#include "common/base/cpu_time.h"
#include "tests/bench/tracker/rendered_hand.h"

namespace cyclorama {

inline TimePoint after(double seconds) {
  return TimePoint(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1000.0 + seconds)));
}

/// One picture's errors, before the filter.
struct PoseError {
  double true_yaw_deg;
  double yaw_deg, x_mm;
  double yaw_in_deviations;  ///< Error of the yaw in units of the pose's own standard deviation.
  std::size_t tags;
};

struct PoseRun {
  std::vector<PoseError> errors;
  std::vector<double> seconds;  ///< Processor time of search and pose, per picture.
  int pictures = 0;
  int company = 0;  ///< Pictures in which another visitor's wand was followed.
};

inline constexpr int kPicturesOfScene = 10;

inline void add_scene(const HandStudio& studio, const HandScene& scene, std::uint64_t number,
                      const tracker::TrackingSettings& settings, tags::TagSearch* search, PoseRun* run) {
  tracker::TrackingState state;
  for (int i = 0; i < kPicturesOfScene; ++i) {
    const GreyImage picture = studio.picture(scene, i, number * kPicturesOfScene + static_cast<std::uint64_t>(i));
    const double began = thread_cpu_seconds();
    const auto found = search->search(picture);
    const tracker::TrackingResult result =
        tracker::track(settings, state, found ? *found : std::vector<tags::TagDetection>{}, studio.lens(),
                       after(static_cast<double>(number) * 10.0 + i / HandScene::kPicturesPerSecond));
    run->seconds.push_back(thread_cpu_seconds() - began);
    state = result.state;
    ++run->pictures;
    if (!result.tag) continue;
    if (result.tag->wand.id() != studio.wand_id()) {  // The first wand seen keeps control, even another visitor's.
      ++run->company;
      continue;
    }
    const HandPose truth = scene.truth(i);
    const tracker::T_CameraTag& pose = result.tag->chosen.pose.T_camera_tag;
    const double yaw = std::remainder(tracker::yaw_rad(pose) - tracker::yaw_rad(truth), 2.0 * 3.141592653589793);
    run->errors.push_back({tracker::yaw_rad(truth) / kDegree, yaw / kDegree,
                           1e3 * (pose.translation().x() - truth.translation().x()),
                           yaw / std::sqrt(std::max(1e-12, result.tag->covariance(1, 1))), result.tag->seen.size()});
  }
}

struct PoseFigures {
  double yaw_sd_deg, yaw_bias_deg, x_sd_mm, yaw_p99_deg, claimed;
  int flips, frames, lost, company;
};

/// Deviations are about the mean of each 15 degrees of true yaw; the bias is the largest such mean.
inline PoseFigures figures_of(const PoseRun& run) {
  constexpr int kBins = 24;
  std::array<double, kBins> count{}, sum{}, sum_x{};
  const auto bin_of = [](double yaw_deg) {
    return static_cast<std::size_t>(std::clamp((yaw_deg + 180.0) / 15.0, 0.0, kBins - 1.0));
  };
  for (const PoseError& e : run.errors) {
    const std::size_t bin = bin_of(e.true_yaw_deg);
    count[bin] += 1.0;
    sum[bin] += e.yaw_deg;
    sum_x[bin] += e.x_mm;
  }
  PoseFigures figures{
      0, 0, 0, 0, 0, 0, run.pictures, run.pictures - static_cast<int>(run.errors.size()) - run.company, run.company};
  std::vector<double> sizes;
  for (const PoseError& e : run.errors) {
    const std::size_t bin = bin_of(e.true_yaw_deg);
    figures.yaw_sd_deg += std::pow(e.yaw_deg - sum[bin] / count[bin], 2);
    figures.x_sd_mm += std::pow(e.x_mm - sum_x[bin] / count[bin], 2);
    figures.claimed += e.yaw_in_deviations * e.yaw_in_deviations;
    // A flip turns the picture to the wrong side; within three degrees of zero the sign has no meaning.
    const double measured = e.true_yaw_deg + e.yaw_deg;
    if (std::abs(e.true_yaw_deg) > 3.0 && measured * e.true_yaw_deg < 0.0) ++figures.flips;
    sizes.push_back(std::abs(e.yaw_deg));
  }
  const double n = std::max<double>(1.0, static_cast<double>(run.errors.size()));
  figures.yaw_sd_deg = std::sqrt(figures.yaw_sd_deg / n);
  figures.x_sd_mm = std::sqrt(figures.x_sd_mm / n);
  figures.claimed = std::sqrt(figures.claimed / n);
  for (std::size_t i = 0; i < kBins; ++i) {
    if (count[i] >= 30.0) figures.yaw_bias_deg = std::max(figures.yaw_bias_deg, std::abs(sum[i] / count[i]));
  }
  std::sort(sizes.begin(), sizes.end());
  if (!sizes.empty()) figures.yaw_p99_deg = sizes[sizes.size() * 99 / 100];
  return figures;
}

}  // namespace cyclorama
