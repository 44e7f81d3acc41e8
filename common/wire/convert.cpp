// SPDX-License-Identifier: Apache-2.0
#include "common/wire/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/picture_cut.h"
#include "common/image/inverse_depth.h"

namespace cyclorama {
namespace {

// Limits of a view; renderfarm/render/quality.h allows at least as much.
constexpr std::uint32_t kMaxSamples = 4096;
constexpr std::uint32_t kMaxBounces = 64;
constexpr std::uint32_t kMaxLightSamples = 16;
constexpr float kMaxRadianceLimit = 1e9f;
// Those of renderfarm/scene/lamp_groups.h, without group 0.
constexpr int kMaxLampLevels = 7;
constexpr float kMaxLampLevel = 4.0f;
// Far beyond any scene, but within the range of float, which the ray kernels use.
constexpr double kMaxEyeCoordinateM = 1e7;
constexpr double kSteepest = 1e4;           // Maximum tangent, within a hundredth of a degree of a right angle.
constexpr double kMaxEyeDistance_m = 1.0;   // Upper bound of the interpupillary distance; adults have about 0.063 m.

Error refuse(const char* field, const std::string& what) {
  return Error(ErrorCode::kInvalidArgument, fmt::format("view.{} {}", field, what));
}

Status check_max(const char* field, std::uint32_t value, std::uint32_t max) {
  if (value <= max) return Done{};
  return refuse(field, fmt::format("is {}; it must be at most {}", value, max));
}

Status is_light(const char* field, float value) {
  if (value >= 0.0f && value <= kMaxRadianceLimit) return Done{};
  return refuse(field, fmt::format("is {}; it must be 0 to {}", value, kMaxRadianceLimit));
}

/// Separates the two eyes' pictures: `height` becomes the height of one picture.
Result<Viewing> viewing_of(const wire::EyePair& eyes, int* height) {
  const auto refuse_eyes = [](const std::string& what) {
    return Error(ErrorCode::kInvalidArgument, "panorama." + what);
  };
  if (*height % (2 * kCutPx) != 0) {
    return refuse_eyes(fmt::format("height_px is {}; that of two eyes must be a multiple of {}", *height, 2 * kCutPx));
  }
  if (!(eyes.distance_m() > 0.0 && eyes.distance_m() <= kMaxEyeDistance_m)) {
    return refuse_eyes(
        fmt::format("eyes.distance_m is {}; it must be above 0 and at most {}", eyes.distance_m(), kMaxEyeDistance_m));
  }
  *height /= 2;
  Viewing viewing;
  viewing.eyes = Eyes::kOverUnder;
  viewing.eye_distance_m = eyes.distance_m();
  if (eyes.screen_distance_m() != 0.0) viewing.screen_distance_m = eyes.screen_distance_m();
  return viewing;
}

Status validate_knobs(const wire::View& view) {
  if (view.samples() < 1 || view.samples() > kMaxSamples) {
    return refuse("samples", fmt::format("is {}; it must be 1 to {}", view.samples(), kMaxSamples));
  }
  TRY(check_max("first_sample", view.first_sample(), kMaxSamples - view.samples()));
  TRY(check_max("sequence", view.sequence(), kMaxSamples));
  TRY(check_max("bounces", view.bounces(), kMaxBounces));
  TRY(check_max("light_samples", view.light_samples(), kMaxLightSamples));
  TRY(is_light("firefly_limit", view.firefly_limit()));
  TRY(is_light("adaptive_error", view.adaptive_error()));
  if (view.adaptive_minimum() == 1) return refuse("adaptive_minimum", "is 1; it must be 0 or at least 2");
  TRY(check_max("adaptive_minimum", view.adaptive_minimum(), kMaxSamples));
  TRY(check_max("prior_samples", view.prior_samples(), kMaxSamples));
  TRY(is_light("prior_weight", view.prior_weight()));
  if (view.lamp_levels_size() > kMaxLampLevels)
    return refuse("lamp_levels", fmt::format("are {}; there may be {}", view.lamp_levels_size(), kMaxLampLevels));
  for (const float level : view.lamp_levels()) {
    if (!(level >= 0.0f && level <= kMaxLampLevel))
      return refuse("lamp_levels", fmt::format("has {}; levels must be 0 to {}", level, kMaxLampLevel));
  }
  if (view.jpeg_quality() >= 1 && view.jpeg_quality() <= 100) return Done{};
  return refuse("jpeg_quality", fmt::format("is {}; it must be 1 to 100", view.jpeg_quality()));
}

}  // namespace

Eigen::Vector3d from_wire(const wire::Vector3& v) { return {v.x(), v.y(), v.z()}; }

void to_wire(const Eigen::Vector3d& v, wire::Vector3* ret_v) {
  ret_v->set_x(v.x());
  ret_v->set_y(v.y());
  ret_v->set_z(v.z());
}

Result<Projection> from_wire(const wire::Panorama& p) {
  // A count beyond int becomes negative or large; validate() refuses both.
  const int width = static_cast<int>(p.width_px());
  int height = static_cast<int>(p.height_px());
  Viewing viewing;
  if (p.has_eyes()) {
    TRY_ASSIGN(viewing, viewing_of(p.eyes(), &height));
  }
  PictureShape shape;
  switch (p.projection()) {
    case wire::Panorama::CYLINDER:
      shape = Panorama{width, height, p.azimuth_span_rad(), p.tan_elevation_top(), p.tan_elevation_bottom()};
      break;
    case wire::Panorama::PERSPECTIVE:
      shape = Perspective{width, height, p.tan_left(), p.tan_right(), p.tan_top(), p.tan_bottom(), p.tilt_rad()};
      break;
    case wire::Panorama::FISHEYE:
      shape = Fisheye{width, height, p.field_rad(), p.tilt_rad()};
      break;
    default:
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("panorama projection is {}, which this program does not support; update it",
                               static_cast<int>(p.projection())));
  }
  const Projection picture{shape, viewing};
  TRY(picture.validate());
  return picture;
}

void to_wire(const PictureShape& shape, wire::Panorama* ret_p) {
  ret_p->Clear();
  ret_p->set_width_px(static_cast<std::uint32_t>(width_px(shape)));
  ret_p->set_height_px(static_cast<std::uint32_t>(height_px(shape)));
  if (const auto* panorama = std::get_if<Panorama>(&shape)) {
    ret_p->set_azimuth_span_rad(panorama->azimuth_span_rad);
    ret_p->set_tan_elevation_top(panorama->tan_elevation_top);
    ret_p->set_tan_elevation_bottom(panorama->tan_elevation_bottom);
  } else if (const auto* flat = std::get_if<Perspective>(&shape)) {
    ret_p->set_projection(wire::Panorama::PERSPECTIVE);
    ret_p->set_tan_left(flat->tan_left);
    ret_p->set_tan_right(flat->tan_right);
    ret_p->set_tan_top(flat->tan_top);
    ret_p->set_tan_bottom(flat->tan_bottom);
    ret_p->set_tilt_rad(flat->tilt_rad);
  } else {
    const auto* fisheye = std::get_if<Fisheye>(&shape);
    CHECK(fisheye != nullptr);
    ret_p->set_projection(wire::Panorama::FISHEYE);
    ret_p->set_field_rad(fisheye->field_rad);
    ret_p->set_tilt_rad(fisheye->tilt_rad);
  }
}

void to_wire(const Projection& picture, wire::Panorama* ret_p) {
  const Viewing& viewing = picture.viewing;
  CHECK(viewing.viewer_m.isZero(0.0) && (viewing.eyes == Eyes::kMono || viewing.eyes == Eyes::kOverUnder));
  to_wire(picture.shape, ret_p);
  if (picture.stacked() == 1) return;
  ret_p->set_height_px(static_cast<std::uint32_t>(picture.height_px()));
  ret_p->mutable_eyes()->set_distance_m(viewing.eye_distance_m);
  if (std::isfinite(viewing.screen_distance_m)) ret_p->mutable_eyes()->set_screen_distance_m(viewing.screen_distance_m);
}

Status validate(const wire::View& view) {
  if (view.number() == 0) return refuse("number", "is 0; views count from 1");
  if (!from_wire(view.eye_m()).allFinite()) return refuse("eye_m", "is not finite");
  if (!(from_wire(view.eye_m()).cwiseAbs().maxCoeff() <= kMaxEyeCoordinateM)) return refuse("eye_m", "is too far away");
  if (!std::isfinite(view.heading_rad())) return refuse("heading_rad", "is not finite");
  TRY(validate_knobs(view));
  TRY_ASSIGN(const Projection whole, from_wire(view.panorama()));
  const PictureShape& picture = whole.shape;
  double steepest = 0.0;
  if (const auto* panorama = std::get_if<Panorama>(&picture)) {
    steepest = std::max(panorama->tan_elevation_top, -panorama->tan_elevation_bottom);
  } else if (const auto* flat = std::get_if<Perspective>(&picture)) {
    steepest = std::max({flat->tan_right, -flat->tan_left, flat->tan_top, -flat->tan_bottom});
  }
  if (steepest <= kSteepest) return Done{};
  return refuse("panorama", fmt::format("has an angle beyond a tangent of {}", kSteepest));
}

Status validate(const wire::Tile& tile, int width_px, int height_px) {
  const std::uint64_t right = std::uint64_t{tile.x_px()} + tile.width_px();
  const std::uint64_t bottom = std::uint64_t{tile.y_px()} + tile.height_px();
  if (tile.width_px() == 0 || tile.height_px() == 0 || tile.x_px() % kCutPx != 0 || tile.y_px() % kCutPx != 0 ||
      right > static_cast<std::uint64_t>(width_px) || bottom > static_cast<std::uint64_t>(height_px)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("tile {}x{} at ({}, {}) does not fit a picture of {}x{}", tile.width_px(),
                             tile.height_px(), tile.x_px(), tile.y_px(), width_px, height_px));
  }
  // Encoded depth is never longer than its values, except for zstd's headers.
  constexpr std::size_t kHeaderBytes = 1024;
  const PixelRect cells = depth_cells({0, 0, static_cast<int>(tile.width_px()), static_cast<int>(tile.height_px())});
  const std::size_t max_bytes = sizeof(std::uint16_t) * static_cast<std::size_t>(cells.area()) + kHeaderBytes;
  if (tile.depth().size() > max_bytes) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("tile {}x{} has {} bytes of depth; it may have {}", tile.width_px(), tile.height_px(),
                             tile.depth().size(), max_bytes));
  }
  return Done{};
}

Status validate(const wire::SceneDescription& scene) {
  const auto refuse_scene = [](const std::string& what) { return Error(ErrorCode::kInvalidArgument, "scene." + what); };
  const auto is_pose = [](const wire::Vector3& eye, double heading) {
    return from_wire(eye).allFinite() && std::isfinite(heading);
  };
  if (scene.name().empty()) return refuse_scene("name is empty");
  if (!is_pose(scene.start_eye_m(), scene.start_heading_rad())) return refuse_scene("start is not finite");
  if (!std::isfinite(scene.eye_height_m())) return refuse_scene("eye_height_m is not finite");
  if (!std::isfinite(scene.walking_scale()) || scene.walking_scale() <= 0.0) {
    return refuse_scene(fmt::format("walking_scale is {}; it must be above 0", scene.walking_scale()));
  }
  if (scene.walkable_size() < 3) {
    return refuse_scene(fmt::format("walkable has {} corners; it must have at least 3", scene.walkable_size()));
  }
  for (const wire::GroundPoint& corner : scene.walkable()) {
    if (!std::isfinite(corner.x_m()) || !std::isfinite(corner.z_m())) return refuse_scene("walkable is not finite");
  }
  for (const wire::GroundPolygon& hole : scene.walkable_holes()) {
    if (hole.corners_size() < 3) return refuse_scene("walkable_holes has one of fewer than 3 corners");
    for (const wire::GroundPoint& corner : hole.corners()) {
      if (!std::isfinite(corner.x_m()) || !std::isfinite(corner.z_m()))
        return refuse_scene("walkable_holes is not finite");
    }
  }
  for (const wire::TourStop& stop : scene.stops()) {
    if (!is_pose(stop.eye_m(), stop.heading_rad())) return refuse_scene("stops: '" + stop.title() + "' is not finite");
  }
  if (scene.lamp_groups_size() > kMaxLampLevels)
    return refuse_scene(
        fmt::format("lamp_groups has {} names; it may have {}", scene.lamp_groups_size(), kMaxLampLevels));
  return Done{};
}

}  // namespace cyclorama
