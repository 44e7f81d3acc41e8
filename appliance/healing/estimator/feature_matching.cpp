// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/feature_matching.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>

namespace cyclorama::healing {
namespace {

constexpr int kMaxFeatures = 1500;
constexpr float kRatio = 0.8f;      // Maximum ratio of distances. Source: Lowe, IJCV 60 (2), 2004.
constexpr double kInlier_px = 8.0;  // In pixels of the projector or the camera; patches refine the pose afterwards.
constexpr int kMinInliers = 12;

/// Converts to OpenCV's 8 bits, perceptually uniform, so that dark parts have features too.
cv::Mat codes_of(const LightPlane& plane) {
  float max = 1e-9f;
  std::vector<float> sorted(plane.light.data().begin(), plane.light.data().end());
  if (!sorted.empty()) {
    const auto high = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 99 / 100);
    std::ranges::nth_element(sorted, high);
    max = std::max(max, *high);
  }
  cv::Mat codes(plane.height(), plane.width(), CV_8U);
  for (int y = 0; y < plane.height(); ++y) {
    const float* row = plane.light.at(0, y);
    for (int x = 0; x < plane.width(); ++x) {
      const float part = std::clamp(row[x] / max, 0.0f, 1.0f);
      codes.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(255.0f * std::sqrt(part) + 0.5f);
    }
  }
  return codes;
}

cv::Ptr<cv::Feature2D> detector(FeatureKind kind) {
  if (kind == FeatureKind::kSift) return cv::SIFT::create(kMaxFeatures, 3, 0.02);
  return cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, 0.0005f);
}

/// Returns the index of each feature's best match, or -1 if the second best is almost as good.
std::vector<int> best_of(const cv::Mat& from, const cv::Mat& to, int norm) {
  std::vector<int> best(static_cast<std::size_t>(from.rows), -1);
  std::vector<std::vector<cv::DMatch>> found;
  cv::BFMatcher(norm).knnMatch(from, to, found, 2);
  for (const auto& pair : found) {
    if (pair.size() == 2 && pair[0].distance < kRatio * pair[1].distance)
      best[static_cast<std::size_t>(pair[0].queryIdx)] = pair[0].trainIdx;
  }
  return best;
}

Eigen::Vector2d place_of(const cv::KeyPoint& point) {
  return {static_cast<double>(point.pt.x) + 0.5, static_cast<double>(point.pt.y) + 0.5};
}

/// Returns T_body_room from points in the room and their positions in the body's picture, as slopes.
std::optional<RigidTransform<frame::Room, frame::Room>> place_from(const std::vector<cv::Point3d>& points,
                                                                   const std::vector<cv::Point2d>& slopes,
                                                                   double inlier_slope) {
  if (points.size() < static_cast<std::size_t>(kMinInliers)) return std::nullopt;
  try {
    cv::Mat turn;
    cv::Mat shift;
    std::vector<int> inliers;
    const bool is_found = cv::solvePnPRansac(points, slopes, cv::Matx33d::eye(), cv::noArray(), turn, shift, false, 300,
                                             static_cast<float>(inlier_slope), 0.999, inliers, cv::SOLVEPNP_SQPNP);
    if (!is_found || static_cast<int>(inliers.size()) < kMinInliers) return std::nullopt;
    std::vector<cv::Point3d> good;
    std::vector<cv::Point2d> seen;
    for (const int i : inliers) {
      good.push_back(points[static_cast<std::size_t>(i)]);
      seen.push_back(slopes[static_cast<std::size_t>(i)]);
    }
    cv::solvePnPRefineLM(good, seen, cv::Matx33d::eye(), cv::noArray(), turn, shift);
    const Eigen::Vector3d w(turn.at<double>(0), turn.at<double>(1), turn.at<double>(2));
    const Eigen::Vector3d t(shift.at<double>(0), shift.at<double>(1), shift.at<double>(2));
    if (!w.allFinite() || !t.allFinite()) return std::nullopt;
    return RigidTransform<frame::Room, frame::Room>(calibration::turned_by(w), t);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}

/// Returns the step to a found pose, unless it exceeds the extent of a bump.
template <typename Body>
std::optional<calibration::PoseStep> plausible(const RigidTransform<frame::Room, Body>& believed,
                                               const RigidTransform<frame::Room, frame::Room>& T_body_room) {
  const auto found = T_body_room.inverse();
  const calibration::PoseStep step =
      calibration::step_between(believed, RigidTransform<frame::Room, Body>(found.rotation(), found.translation()));
  if (!(step.head<3>().norm() < 2.0 * calibration::kMaxTurn_rad &&
        step.tail<3>().norm() < 2.0 * calibration::kMaxShift_m))
    return std::nullopt;
  return step;
}

}  // namespace

Result<FeatureMatches> match_features(const Prediction& prediction, const LightPlane& picture, FeatureKind kind) {
  try {
    const cv::Ptr<cv::Feature2D> features = detector(kind);
    std::vector<cv::KeyPoint> expected;
    std::vector<cv::KeyPoint> seen;
    cv::Mat expected_words;
    cv::Mat seen_words;
    features->detectAndCompute(codes_of(prediction.light), cv::noArray(), expected, expected_words);
    features->detectAndCompute(codes_of(picture), cv::noArray(), seen, seen_words);
    FeatureMatches made;
    made.in_prediction = static_cast<int>(expected.size());
    made.in_picture = static_cast<int>(seen.size());
    if (expected.size() < 2 || seen.size() < 2) return made;
    const int norm = kind == FeatureKind::kSift ? cv::NORM_L2 : cv::NORM_HAMMING;
    const std::vector<int> forth = best_of(expected_words, seen_words, norm);
    const std::vector<int> back = best_of(seen_words, expected_words, norm);
    for (std::size_t i = 0; i < forth.size(); ++i) {
      if (forth[i] < 0 || back[static_cast<std::size_t>(forth[i])] != static_cast<int>(i)) continue;
      const Eigen::Vector2d at = place_of(expected[i]);
      const int who = *prediction.owner.at(std::clamp(static_cast<int>(at.x()), 0, prediction.owner.width() - 1),
                                           std::clamp(static_cast<int>(at.y()), 0, prediction.owner.height() - 1));
      if (who < 0) continue;
      made.matches.push_back({at, place_of(seen[static_cast<std::size_t>(forth[i])]), who});
    }
    return made;
  } catch (const cv::Exception& e) {
    return Error(ErrorCode::kBadData, std::string("matching features: ") + e.what());
  }
}

std::optional<calibration::PoseStep> find_projector(const calibration::ShowCalibration& room, std::size_t projector,
                                                    std::span<const PatchObservation> observations) {
  const calibration::ShowProjector& lamp = room.projectors[projector];
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> slopes;
  for (const PatchObservation& s : observations) {
    if (s.projector != projector) continue;
    const auto slope = calibration::slope_at(lamp.lens, s.shown);
    if (!slope) continue;
    points.emplace_back(s.wall.x(), s.wall.y(), s.wall.z());
    slopes.emplace_back(slope->x(), slope->y());
  }
  const auto T = place_from(points, slopes, kInlier_px / lamp.lens.focal_u_px);
  return T ? plausible(lamp.T_room_projector, *T) : std::nullopt;
}

std::optional<calibration::PoseStep> find_camera(const calibration::ShowCalibration& room, std::size_t camera,
                                                 std::span<const PatchObservation> observations) {
  const calibration::ShowCamera& eye = room.cameras[camera];
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> slopes;
  for (const PatchObservation& s : observations) {
    if (s.camera != camera) continue;
    const auto wall = calibration::wall_lit_at(room, room.projectors[s.projector], s.shown);
    const auto slope = calibration::slope_at(eye.lens, s.seen);
    if (!slope || !wall) continue;
    points.emplace_back(wall->x(), wall->y(), wall->z());
    slopes.emplace_back(slope->x(), slope->y());
  }
  const auto T = place_from(points, slopes, kInlier_px / eye.lens.focal_u_px);
  return T ? plausible(eye.T_room_camera, *T) : std::nullopt;
}

}  // namespace cyclorama::healing
