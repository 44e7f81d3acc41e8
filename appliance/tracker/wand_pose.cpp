// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/wand_pose.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/check.h"

namespace cyclorama::tracker {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Angle between two minima below which they count as one.
constexpr double kSamePoseRad = 0.01;
/// A second pose is dropped if its misfit exceeds the best one's by more than this: its odds are then exp(-kHopeless /
/// 2).
constexpr double kHopeless = 60.0;
/// Misfit added by a tag that should be visible but is not found: odds of only e to 1, since hands cover tags.
constexpr double kMissingTag = 2.0;
/// A tag should be visible if it is this large, turned towards the camera by this much, and this far inside the
/// picture.
constexpr double kSurelySeenSidePx = 11.0;
constexpr double kSurelySeenCosine = 0.5;
constexpr double kInsidePx = 6.0;

struct Match {
  const WandTag* tag;
  const tags::TagDetection* detection;
};

std::vector<Match> matches_of(const Wand& wand, std::span<const tags::TagDetection> seen) {
  std::vector<Match> matches;
  for (const WandTag& tag : wand.tags) {
    const auto found = std::find_if(seen.begin(), seen.end(),
                                    [&](const tags::TagDetection& detection) { return detection.id == tag.id; });
    const bool usable = found != seen.end() && std::all_of(found->corners.begin(), found->corners.end(),
                                                           [](const Vector2d& corner) { return corner.allFinite(); });
    if (usable) matches.push_back({&tag, &*found});
  }
  return matches;
}

std::vector<SeenPoint> points_of(std::span<const Match> matches, double corner_floor_px) {
  std::vector<SeenPoint> points;
  for (const Match& match : matches) {
    for (std::size_t i = 0; i < 4; ++i) {
      Eigen::Matrix2d covariance = match.detection->covariance[i];
      covariance.diagonal().array() += corner_floor_px * corner_floor_px;
      const Eigen::Matrix2d information = covariance.inverse();
      if (!information.allFinite()) continue;
      points.push_back({match.tag->corners[i], match.detection->corners[i], information});
    }
  }
  return points;
}

/// Returns the cosine between a tag's normal and the ray to it: 1 from the front, negative from behind.
double facing(const WandTag& tag, const T_CameraTag& pose) {
  const auto face = face_of(tag);
  const Vector3d into = pose.rotation() * (face.rotation() * Vector3d::UnitZ());
  const Vector3d centre = (pose * Point<frame::Tag>{face.translation()}).xyz;
  return into.dot(centre.normalized());
}

bool should_be_seen(const WandTag& tag, const T_CameraTag& pose, const Pinhole& lens) {
  if (!(facing(tag, pose) > kSurelySeenCosine)) return false;
  std::array<Vector2d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = lens.pixel_of((pose * Point<frame::Tag>{tag.corners[i]}).xyz);
    if (!pixel) return false;
    const bool inside = pixel->x() > kInsidePx && pixel->y() > kInsidePx && pixel->x() < lens.width_px - kInsidePx &&
                        pixel->y() < lens.height_px - kInsidePx;
    if (!inside) return false;
    corners[i] = *pixel;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if ((corners[(i + 1) % 4] - corners[i]).norm() < kSurelySeenSidePx) return false;
  }
  return true;
}

bool is_seen(const WandTag& tag, std::span<const Match> matches) {
  return std::any_of(matches.begin(), matches.end(), [&](const Match& match) { return match.tag == &tag; });
}

/// Returns the refined pose with its misfit; empty if the pose would turn a visible tag away from the camera.
std::optional<TagPose> explain(const Wand& wand, std::span<const Match> matches, std::span<const SeenPoint> points,
                               const T_CameraTag& start, const Pinhole& lens) {
  std::optional<TagPose> pose = fit_pose(points, start, lens);
  if (!pose) return std::nullopt;
  for (const WandTag& tag : wand.tags) {
    const bool seen = is_seen(tag, matches);
    if (seen && !(facing(tag, pose->T_camera_tag) > 0.0)) return std::nullopt;
    if (!seen && should_be_seen(tag, pose->T_camera_tag, lens)) pose->misfit += kMissingTag;
  }
  return pose;
}

bool is_same(const TagPose& a, const TagPose& b) {
  return a.T_camera_tag.rotation().angularDistance(b.T_camera_tag.rotation()) < kSamePoseRad;
}

}  // namespace

std::optional<TagPoses> estimate_wand_poses(const Wand& wand, std::span<const tags::TagDetection> seen,
                                            double corner_floor_px, const Pinhole& lens) {
  CHECK(corner_floor_px > 0.0 && lens.focal_px > 0.0);
  const std::vector<Match> matches = matches_of(wand, seen);
  const std::vector<SeenPoint> points = points_of(matches, corner_floor_px);
  std::vector<TagPose> explanations;
  for (const Match& match : matches) {
    const auto proposed = estimate_poses(match.detection->corners, match.tag->size_m, lens);
    if (!proposed) continue;
    const auto face = face_of(*match.tag);
    const auto add = [&](const TagPose& alone) {
      const RigidTransform<frame::Camera, frame::Face> T_camera_face(alone.T_camera_tag.rotation(),
                                                                     alone.T_camera_tag.translation());
      const auto pose = explain(wand, matches, points, T_camera_face * face.inverse(), lens);
      if (!pose) return;
      const auto same = std::find_if(explanations.begin(), explanations.end(),
                                     [&](const TagPose& known) { return is_same(known, *pose); });
      if (same == explanations.end()) {
        explanations.push_back(*pose);
      } else if (pose->misfit < same->misfit) {
        *same = *pose;
      }
    };
    add(proposed->best);
    if (proposed->other) add(*proposed->other);
  }
  if (explanations.empty()) return std::nullopt;
  std::sort(explanations.begin(), explanations.end(),
            [](const TagPose& a, const TagPose& b) { return a.misfit < b.misfit; });
  TagPoses poses{explanations[0], std::nullopt};
  if (explanations.size() > 1 && explanations[1].misfit - explanations[0].misfit < kHopeless) {
    poses.other = explanations[1];
  }
  return poses;
}

Matrix6d mixed_covariance(const TagPose& chosen, const TagPose& other, double probability) {
  const Eigen::AngleAxisd turn(other.T_camera_tag.rotation() * chosen.T_camera_tag.rotation().conjugate());
  Eigen::Matrix<double, 6, 1> apart;
  apart << turn.angle() * turn.axis(), other.T_camera_tag.translation() - chosen.T_camera_tag.translation();
  return probability * chosen.covariance + (1.0 - probability) * (other.covariance + apart * apart.transpose());
}

}  // namespace cyclorama::tracker
