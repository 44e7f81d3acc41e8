// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/screen_edges.h"

#include <array>
#include <cmath>
#include <optional>

namespace cyclorama::healing {
namespace {

constexpr int kEvery_px = 16;  // Distance between points, in pixels of the reduced picture.
constexpr int kSearchRadius_px = 5;
constexpr int kBeyond_px = 3;           // Distance inside an edge at which light is sampled.
constexpr double kMinEdgeStep = 0.004;  // Minimum step across the edge, as a share of the camera's full scale.
constexpr double kSigma_px = 0.6;       // In pixels of the reduced picture; content beside an edge shifts it.

/// Tests whether a camera's ray meets the wall.
class WallRay {
 public:
  WallRay(const Wall& wall, const calibration::ShowCamera& camera) : wall_(wall), camera_(camera) {}
  [[nodiscard]] bool meets(const Eigen::Vector2d& pixel) const {
    const auto slope = calibration::slope_at(camera_.lens, pixel);
    return slope &&
           hit(wall_, {{camera_.T_room_camera.translation()}, camera_.T_room_camera.rotation() * slope->homogeneous()});
  }
  /// Returns the position of the wall's edge between a pixel that meets the wall and one that does not.
  [[nodiscard]] std::optional<Eigen::Vector2d> end(Eigen::Vector2d inside, Eigen::Vector2d outside) const {
    if (!meets(inside) || meets(outside)) return std::nullopt;
    while ((outside - inside).norm() > 1e-4) {
      const Eigen::Vector2d middle = 0.5 * (inside + outside);
      (meets(middle) ? inside : outside) = middle;
    }
    return 0.5 * (inside + outside);
  }

 private:
  const Wall& wall_;
  const calibration::ShowCamera& camera_;
};

std::optional<EdgePoint> edge_point(const Wall& wall, const calibration::ShowCamera& camera,
                                    const Eigen::Vector2d& inside, const Eigen::Vector2d& outside) {
  const WallRay observation(wall, camera);
  const auto at = observation.end(inside, outside);
  if (!at) return std::nullopt;
  // The tangent is computed from the edge's positions a few pixels to either side.
  const Eigen::Vector2d out = (outside - inside).normalized();
  const Eigen::Vector2d along(-out.y(), out.x());
  constexpr double kBeside_px = 6.0;
  constexpr double kSearch_px = 8.0;
  const auto ahead =
      observation.end(*at + kBeside_px * along - kSearch_px * out, *at + kBeside_px * along + kSearch_px * out);
  const auto behind =
      observation.end(*at - kBeside_px * along - kSearch_px * out, *at - kBeside_px * along + kSearch_px * out);
  if (!ahead || !behind) return std::nullopt;
  const Eigen::Vector2d tangent = (*ahead - *behind).normalized();
  EdgePoint point;
  point.at = *at;
  point.outward = {tangent.y(), -tangent.x()};
  if (point.outward.dot(out) < 0.0) point.outward = -point.outward;
  for (int axis = 0; axis < 6; ++axis) {
    calibration::PoseStep step = calibration::PoseStep::Zero();
    step[axis] = axis < 3 ? 1e-4 : 1e-4;
    calibration::ShowCamera moved = camera;
    moved.T_room_camera = calibration::stepped(camera.T_room_camera, step);
    const auto end = WallRay(wall, moved).end(*at - 4.0 * point.outward, *at + 4.0 * point.outward);
    if (!end) return std::nullopt;
    point.by_camera[axis] = (*end - *at).dot(point.outward) / step[axis];
  }
  return point;
}

}  // namespace

std::vector<EdgePoint> edge_points(const Wall& wall, const calibration::ShowCamera& camera, const CameraSlopes& slopes,
                                   const SeenWall& seen) {
  std::vector<EdgePoint> points;
  const int margin = kSearchRadius_px + kBeyond_px + 2;
  const auto is_wall = [&](int x, int y) {
    return !std::isnan(
        seen.points[static_cast<std::size_t>(y) * static_cast<std::size_t>(seen.width) + static_cast<std::size_t>(x)]
            .x());
  };
  const auto centre = [&](int x, int y) {
    return Eigen::Vector2d((x + 0.5) * slopes.factor, (y + 0.5) * slopes.factor);
  };
  const auto add = [&](int x0, int y0, int x1, int y1, bool is_column) {
    if (is_wall(x0, y0) == is_wall(x1, y1)) return;
    const bool is_first_inside = is_wall(x0, y0);
    const Eigen::Vector2d inside = is_first_inside ? centre(x0, y0) : centre(x1, y1);
    const Eigen::Vector2d outside = is_first_inside ? centre(x1, y1) : centre(x0, y0);
    auto point = edge_point(wall, camera, inside, outside);
    if (!point) return;
    // Steep edges are sought in rows, the others in columns.
    if ((std::abs(point->outward.y()) > std::abs(point->outward.x())) != is_column) return;
    point->part = !is_column ? Outline::kSide : point->outward.y() < 0.0 ? Outline::kUpper : Outline::kLower;
    points.push_back(*point);
  };
  for (int x = margin; x + margin < seen.width; x += kEvery_px) {
    for (int y = margin; y + margin < seen.height; ++y) add(x, y, x, y + 1, true);
  }
  for (int y = margin; y + margin < seen.height; y += kEvery_px) {
    for (int x = margin; x + margin < seen.width; ++x) add(x, y, x + 1, y, false);
  }
  return points;
}

std::vector<EdgePoint> lit_across(const std::vector<EdgePoint>& points, const calibration::ShowCalibration& room,
                                  std::size_t camera, int factor, std::span<const LightPlane> shone) {
  // Minimum light outside relative to the light inside; less than 1, since the content may change over some pixels.
  constexpr double kGoesOn = 0.5;
  const calibration::ShowCamera& eye = room.cameras[camera];
  const auto light = [&](const EdgePoint& point, double out_px) {
    const auto wall = calibration::wall_seen_at(room, eye, point.at + out_px * factor * point.outward);
    double sum = 0.0;
    for (std::size_t i = 0; wall && i < shone.size(); ++i) {
      if (shone[i].light.empty()) continue;
      const calibration::ShowProjector& lamp = room.projectors[i];
      const auto pixel =
          calibration::pixel_of(lamp.lens, (lamp.T_room_projector.inverse() * Point<frame::Room>{*wall}).xyz);
      if (!pixel || !calibration::contains(lamp.lens, *pixel)) continue;
      const double by = shone[i].factor;
      sum += static_cast<double>(shone[i].at(static_cast<float>(pixel->x() / by), static_cast<float>(pixel->y() / by)));
    }
    return sum;
  };
  std::vector<EdgePoint> lit;
  for (const EdgePoint& point : points) {
    const double inside = light(point, -kBeyond_px);
    if (inside > 0.0 && light(point, 1.5) > kGoesOn * inside && light(point, kSearchRadius_px + 1) > kGoesOn * inside)
      lit.push_back(point);
  }
  return lit;
}

std::vector<EdgeObservation> observe_edges(const std::vector<EdgePoint>& points, std::size_t camera,
                                           const Prediction& prediction, const LightPlane& picture, double gain) {
  std::vector<EdgeObservation> seen;
  const double factor = prediction.light.factor;
  for (const EdgePoint& point : points) {
    const Eigen::Vector2d at = point.at / factor;
    const auto light = [&](const LightPlane& plane, double out_px) {
      const Eigen::Vector2d position = at + out_px * point.outward;
      return static_cast<double>(plane.at(static_cast<float>(position.x()), static_cast<float>(position.y())));
    };
    if (!(gain * light(prediction.light, -kBeyond_px) > kMinEdgeStep)) continue;
    std::array<double, 2 * kSearchRadius_px + 1> fall{};
    std::size_t steepest = 0;
    for (std::size_t i = 0; i < fall.size(); ++i) {
      const double out_px = static_cast<double>(i) - kSearchRadius_px;
      fall[i] = light(picture, out_px - 1.0) - light(picture, out_px + 1.0);
      if (fall[i] > fall[steepest]) steepest = i;
    }
    if (steepest == 0 || steepest + 1 == fall.size() || !(fall[steepest] > kMinEdgeStep)) continue;
    const double bend = fall[steepest - 1] - 2.0 * fall[steepest] + fall[steepest + 1];
    if (!(bend < 0.0)) continue;
    const double off =
        static_cast<double>(steepest) - kSearchRadius_px + 0.5 * (fall[steepest - 1] - fall[steepest + 1]) / bend;
    seen.push_back({camera, point.part, point.at, off * factor, kSigma_px * factor, point.by_camera});
  }
  return seen;
}

}  // namespace cyclorama::healing
