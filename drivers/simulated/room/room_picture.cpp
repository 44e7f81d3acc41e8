// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/room/room_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"
#include "common/image/colour.h"

namespace cyclorama::simulated {
namespace {

constexpr float kWallAlbedo = 0.9f;
constexpr float kFloorAlbedo = 0.35f;
/// Stray light that makes the shapes of a dark room visible.
constexpr float kWallInTheDark = 0.004f;
constexpr float kFloorInTheDark = 0.0012f;
/// The floor's glow is smooth, so few wall patches and floor cells suffice.
constexpr std::size_t kPatches = 96;
constexpr int kFloorCells = 24;
constexpr std::size_t kAround = 1000;
constexpr double kMaxHalfWidth = 1.2;  // Upper bound on the half width of the eye's view.

struct SrgbTable {
  std::array<float, 256> linear{};
  SrgbTable() {
    for (std::size_t i = 0; i < linear.size(); ++i) linear[i] = srgb_to_linear(static_cast<float>(i) / 255.0f);
  }
};

float linear_of(std::uint8_t code) {
  static const SrgbTable table;
  return table.linear[code];
}

/// Interpolates bilinearly in linear light, since the light of neighbouring projector pixels overlaps. (u, v) is a
/// pixel as in Pinhole.
std::array<float, 3> light_at(const RgbImage& picture, float u, float v) {
  const float x = std::clamp(u - 0.5f, 0.0f, static_cast<float>(picture.width() - 1));
  const float y = std::clamp(v - 0.5f, 0.0f, static_cast<float>(picture.height() - 1));
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, picture.width() - 1);
  const int y1 = std::min(y0 + 1, picture.height() - 1);
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  std::array<float, 3> light{};
  for (std::size_t c = 0; c < 3; ++c) {
    const float upper = (1.0f - fx) * linear_of(picture.at(x0, y0)[c]) + fx * linear_of(picture.at(x1, y0)[c]);
    const float lower = (1.0f - fx) * linear_of(picture.at(x0, y1)[c]) + fx * linear_of(picture.at(x1, y1)[c]);
    light[c] = (1.0f - fy) * upper + fy * lower;
  }
  return light;
}

/// Position of a wall point in a projector's picture; nothing if the projector does not light it.
std::optional<Eigen::Vector2d> lit_from(const InstalledProjector& projector, const Wall& wall,
                                        const Point<frame::Room>& wall_point) {
  const auto pixel = projector.lens.pixel_of((projector.T_room_projector.inverse() * wall_point).xyz);
  if (!pixel || !projector.lens.contains(*pixel)) return std::nullopt;
  return is_reached(wall, wall_point, {projector.T_room_projector.translation()}) ? pixel : std::nullopt;
}

}  // namespace

RoomEye RoomEye::behind_visitor(const Installation& installation, int width_px, int height_px) {
  const Eigen::Vector3d visitor = installation.sweet_spot.xyz;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double distance = 0.0;
  const std::vector<WallPatch> around = patches(installation.wall, kAround);
  for (const WallPatch& patch : around) {
    const Eigen::Vector3d seen = patch.middle.xyz - visitor;
    middle += patch.middle.xyz / static_cast<double>(around.size());
    distance += std::hypot(seen.x(), seen.z()) / static_cast<double>(around.size());
  }
  const Eigen::Vector3d behind = visitor + Eigen::Vector3d(0.0, 0.25, 0.75 * distance);
  const Eigen::Vector3d towards = middle - behind;
  const double tilt = std::atan2(towards.y(), -towards.z()) - 0.06;
  const Eigen::Quaterniond looking_ahead(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  RoomEye eye;
  eye.T_room_camera = {Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) * looking_ahead, behind};
  // The view includes both ends of the wall with a margin, as far as a flat picture can show them.
  const RigidTransform<frame::Camera, frame::Room> T_camera_room = eye.T_room_camera.inverse();
  const double aspect = static_cast<double>(width_px) / height_px;
  double half_view = 0.3;
  for (const Point<frame::Room>& point : outline(installation.wall)) {
    const Eigen::Vector3d p = (T_camera_room * point).xyz;
    const double across = std::atan2(std::abs(p.x()), p.z());
    const double along = std::atan(aspect * std::abs(p.y()) / std::max(p.z(), 1e-9));
    half_view = std::max({half_view, 1.12 * across, 1.04 * along});
  }
  eye.lens = Pinhole::from_field_of_view(width_px, height_px, 2.0 * std::min(half_view, kMaxHalfWidth));
  return eye;
}

RoomPicture::RoomPicture(Installation installation, const RoomEye& eye)
    : installation_(std::move(installation)), width_px_(eye.lens.width_px), height_px_(eye.lens.height_px) {
  for (const WallPatch& patch : patches(installation_.wall, kAround)) {
    const Eigen::Vector3d& p = patch.middle.xyz;
    reach_m_ = std::max({reach_m_, 2.0 * std::abs(p.x()), 2.0 * std::abs(p.z())});
  }
  const Point<frame::Room> origin{eye.T_room_camera.translation()};
  for (int y = 0; y < height_px_; ++y) {
    for (int x = 0; x < width_px_; ++x) {
      const auto pixel = static_cast<std::uint32_t>(y * width_px_ + x);
      const RoomRay ray{origin, eye.T_room_camera.rotation() * eye.lens.direction_at(x + 0.5, y + 0.5)};
      if (const auto met = hit(installation_.wall, ray)) {
        look_at_wall(pixel, *met);
      } else {
        look_at_floor(pixel, ray);
      }
    }
  }
}

void RoomPicture::look_at_wall(std::uint32_t eye_pixel, const Point<frame::Room>& wall_point) {
  unlit_wall_.push_back(eye_pixel);
  for (std::size_t i = 0; i < installation_.projectors.size(); ++i) {
    if (const auto pixel = lit_from(installation_.projectors[i], installation_.wall, wall_point)) {
      sources_.push_back(
          {eye_pixel, static_cast<std::uint32_t>(i), static_cast<float>(pixel->x()), static_cast<float>(pixel->y())});
    }
  }
}

void RoomPicture::look_at_floor(std::uint32_t eye_pixel, const RoomRay& ray) {
  if (!(ray.direction.y() < -1e-6)) return;
  const Eigen::Vector3d point = ray.origin.xyz - ray.origin.xyz.y() / ray.direction.y() * ray.direction;
  const double x = (point.x() / reach_m_ + 1.0) * 0.5 * kFloorCells;
  const double z = (point.z() / reach_m_ + 1.0) * 0.5 * kFloorCells;
  if (!(x >= 0.0 && x < kFloorCells && z >= 0.0 && z < kFloorCells)) return;
  floor_.push_back({eye_pixel, static_cast<float>(x), static_cast<float>(z)});
}

std::array<float, 3> RoomPicture::radiance_at(const Point<frame::Room>& wall_point,
                                              std::span<const RgbImage> projector_pictures) const {
  std::array<float, 3> sum{};
  for (std::size_t i = 0; i < installation_.projectors.size(); ++i) {
    const auto pixel = lit_from(installation_.projectors[i], installation_.wall, wall_point);
    if (!pixel || projector_pictures[i].empty()) continue;
    const auto light = light_at(projector_pictures[i], static_cast<float>(pixel->x()), static_cast<float>(pixel->y()));
    for (std::size_t c = 0; c < 3; ++c) sum[c] += kWallAlbedo * light[c];
  }
  return sum;
}

void RoomPicture::add_floor_glow(std::span<const RgbImage> pictures, RadianceImage* radiance) const {
  const std::vector<WallPatch> shining = patches(installation_.wall, kPatches);
  std::vector<std::array<float, 3>> leaving;
  for (const WallPatch& patch : shining) leaving.push_back(radiance_at(patch.middle, pictures));
  constexpr std::size_t kSide = kFloorCells + 1;
  std::vector<std::array<float, 3>> grid(kSide * kSide);
  for (std::size_t iz = 0; iz < kSide; ++iz) {
    for (std::size_t ix = 0; ix < kSide; ++ix) {
      const Eigen::Vector3d floor_point((2.0 * static_cast<double>(ix) / kFloorCells - 1.0) * reach_m_, 0.0,
                                        (2.0 * static_cast<double>(iz) / kFloorCells - 1.0) * reach_m_);
      for (std::size_t i = 0; i < shining.size(); ++i) {
        const WallPatch& patch = shining[i];
        const Eigen::Vector3d to_patch = patch.middle.xyz - floor_point;
        const double distance = std::max(to_patch.norm(), 0.3);  // Patches have an area; avoid the singularity.
        const double cos_floor = to_patch.y() / distance;
        const double cos_patch = -to_patch.dot(patch.normal) / distance;
        if (cos_floor <= 0.0 || cos_patch <= 0.0) continue;
        const auto weight = static_cast<float>(kFloorAlbedo / std::numbers::pi * cos_floor * cos_patch * patch.area_m2 /
                                               (distance * distance));
        for (std::size_t c = 0; c < 3; ++c) grid[iz * kSide + ix][c] += weight * leaving[i][c];
      }
    }
  }
  for (const FloorPixel& pixel : floor_) {
    const auto ix = static_cast<std::size_t>(pixel.x);
    const auto iz = static_cast<std::size_t>(pixel.z);
    const float fx = pixel.x - static_cast<float>(ix);
    const float fz = pixel.z - static_cast<float>(iz);
    const auto& g = grid;
    float* const out = radiance->data().data() + 3 * std::size_t{pixel.eye_pixel};
    for (std::size_t c = 0; c < 3; ++c) {
      const float near_row = (1 - fx) * g[iz * kSide + ix][c] + fx * g[iz * kSide + ix + 1][c];
      const float far_row = (1 - fx) * g[(iz + 1) * kSide + ix][c] + fx * g[(iz + 1) * kSide + ix + 1][c];
      out[c] = kFloorInTheDark + (1 - fz) * near_row + fz * far_row;
    }
  }
}

RgbImage RoomPicture::photograph(std::span<const RgbImage> projector_pictures) const {
  CHECK(projector_pictures.size() == installation_.projectors.size());
  RadianceImage radiance(width_px_, height_px_);
  for (const std::uint32_t pixel : unlit_wall_) {
    std::fill_n(radiance.data().begin() + 3 * std::ptrdiff_t{pixel}, 3, kWallInTheDark);
  }
  for (const Source& source : sources_) {
    const RgbImage& picture = projector_pictures[source.projector];
    if (picture.empty()) continue;
    const auto light = light_at(picture, source.u, source.v);
    float* const out = radiance.data().data() + 3 * std::size_t{source.eye_pixel};
    for (std::size_t c = 0; c < 3; ++c) out[c] += kWallAlbedo * light[c];
  }
  add_floor_glow(projector_pictures, &radiance);
  RgbImage photograph(width_px_, height_px_);
  std::transform(radiance.data().begin(), radiance.data().end(), photograph.data().begin(), linear_to_srgb8);
  return photograph;
}

}  // namespace cyclorama::simulated
