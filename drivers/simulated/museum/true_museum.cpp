// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/true_museum.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"

namespace cyclorama::simulated {
namespace {

constexpr int kBlock = 8;  // Side in pixels of a block whose light is deposited as one; cells are much larger.

int blocks(int pixels) { return (pixels + kBlock - 1) / kBlock; }

double pixel_flux(const TrueProjector& p, const Eigen::Vector2d& ideal) {
  const Pinhole& lens = p.lens.pinhole();
  const double cosine = 1.0 / std::sqrt(1.0 + ideal.squaredNorm());
  return p.flux_lm / lens.width_px / lens.height_px * std::pow(cosine, p.vignetting_exponent);
}

}  // namespace

Result<TrueMuseum> TrueMuseum::make(Installation installation, MuseumTruth truth) {
  TRY_ASSIGN(TrueWall wall, TrueWall::make(truth.wall, truth.T_room_wall, truth.deviation));
  if (truth.projectors.size() != installation.projectors.size()) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("the truth has {} projectors and the installation {}",
                                                          truth.projectors.size(), installation.projectors.size()));
  }
  for (std::size_t i = 0; i < truth.projectors.size(); ++i) {
    const Pinhole& real = truth.projectors[i].lens.pinhole();
    const Pinhole& told = installation.projectors[i].lens;
    if (real.width_px != told.width_px || real.height_px != told.height_px) {
      return Error(
          ErrorCode::kInvalidArgument,
          fmt::format("projector '{}' has {}x{} pixels in the truth and {}x{} in the installation",
                      installation.projectors[i].name, real.width_px, real.height_px, told.width_px, told.height_px));
    }
  }
  TrueMuseum museum(std::move(installation), std::move(truth), std::move(wall));
  const Point<frame::Room> camera{museum.camera_pose(0.0).translation()};
  if (!is_lit_from(museum.truth_.wall, museum.truth_.T_room_wall.inverse() * camera))
    return Error(ErrorCode::kInvalidArgument, "the camera stands behind the wall");
  return museum;
}

TrueMuseum::TrueMuseum(Installation installation, MuseumTruth truth, TrueWall wall)
    : installation_(std::move(installation)),
      truth_(std::move(truth)),
      wall_(std::move(wall)),
      cells_(wall_, truth_.cells) {
  if (truth_.cells > 0) inter_reflection_ = std::make_unique<InterReflection>(wall_, cells_, truth_.albedo);
  for (std::size_t i = 0; i < truth_.projectors.size(); ++i) {
    const TrueProjector& projector = truth_.projectors[i];
    auto& table = light_of_code_.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t code = 0; code < 256; ++code) {
        const double shown = projector.response[c].at(static_cast<double>(code) / 255.0);
        table[c][code] = projector.black[c] + (1.0 - projector.black[c]) * shown;
      }
    }
    deposits_.push_back(deposits_of(i));
  }
}

std::vector<TrueMuseum::Deposit> TrueMuseum::deposits_of(std::size_t projector) const {
  std::vector<Deposit> deposits;
  if (truth_.cells == 0) return deposits;
  const TrueProjector& p = truth_.projectors[projector];
  const int width = p.lens.pinhole().width_px;
  const int height = p.lens.pinhole().height_px;
  for (int y = 0; y < height; y += kBlock) {
    for (int x = 0; x < width; x += kBlock) {
      const double u = 0.5 * (x + std::min(x + kBlock, width));
      const double v = 0.5 * (y + std::min(y + kBlock, height));
      Deposit& deposit = deposits.emplace_back();
      const auto at = wall_at(projector, u, v);
      const auto direction = p.lens.direction_at(u, v);
      if (!at || !direction) continue;
      deposit = {pixel_flux(p, direction->head<2>()), cells_.share(at->position)};
    }
  }
  return deposits;
}

std::optional<TrueWall::Hit> TrueMuseum::wall_at(std::size_t projector, double u, double v) const {
  const TrueProjector& p = truth_.projectors[projector];
  const auto direction = p.lens.direction_at(u, v);
  if (!direction) return std::nullopt;
  return wall_.hit({{p.T_room_projector.translation()}, p.T_room_projector.rotation() * *direction});
}

std::optional<Eigen::Vector3d> TrueMuseum::direction_at(std::size_t projector, double u, double v,
                                                        const Point<frame::Room>& eye) const {
  const auto at = wall_at(projector, u, v);
  if (!at) return std::nullopt;
  return (at->point.xyz - eye.xyz).normalized();
}

std::optional<Eigen::Vector2d> TrueMuseum::projector_pixel(std::size_t projector, const TrueWall::Hit& at) const {
  const TrueProjector& p = truth_.projectors[projector];
  const auto pixel = p.lens.pixel_of((p.T_room_projector.inverse() * at.point).xyz);
  if (!pixel || !wall_.is_reached(at, {p.T_room_projector.translation()})) return std::nullopt;
  return pixel;
}

double TrueMuseum::gain_lux(std::size_t projector, const TrueWall::Hit& at) const {
  const TrueProjector& p = truth_.projectors[projector];
  const Eigen::Vector3d seen = (p.T_room_projector.inverse() * at.point).xyz;
  if (!(seen.z() > 1e-9)) return 0.0;
  const Eigen::Vector2d ideal = seen.head<2>() / seen.z();
  const Eigen::Vector3d towards = p.T_room_projector.translation() - at.point.xyz;
  const double distance = towards.norm();
  const double on_wall = at.normal.dot(towards) / distance;
  if (!(on_wall > 0.0) || !(ideal.norm() < p.lens.max_tangent())) return 0.0;
  const double focal = p.lens.pinhole().focal_px;
  const double steepness = std::pow(1.0 + ideal.squaredNorm(), 1.5);  // 1 / cos^3
  const double px_per_sr = focal * focal * std::abs(p.lens.derivative(ideal).determinant()) * steepness;
  return pixel_flux(p, ideal) * px_per_sr * on_wall / (distance * distance);
}

double TrueMuseum::defocus_px(std::size_t projector, const TrueWall::Hit& at) const {
  const TrueProjector& p = truth_.projectors[projector];
  const double depth = (p.T_room_projector.inverse() * at.point).xyz.z();
  if (!(depth > 1e-9)) return 0.0;
  return p.defocus_px_per_dioptre * std::abs(1.0 / depth - 1.0 / p.focus_distance_m);
}

double TrueMuseum::channel_light(std::size_t projector, std::size_t channel, int code) const {
  CHECK(channel < 3 && code >= 0 && code < 256);
  return light_of_code_[projector][channel][static_cast<std::size_t>(code)];
}

double TrueMuseum::white_light(std::size_t projector, const std::array<double, 3>& channels) const {
  return truth_.projectors[projector].white_segment * std::min({channels[0], channels[1], channels[2]});
}

RoomColour TrueMuseum::colour_of(std::size_t projector, const std::array<int, 3>& code) const {
  RoomColour colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double light = channel_light(projector, c, code[c]);
    for (std::size_t r = 0; r < 3; ++r) colour[r] += light * truth_.projectors[projector].primaries[c][r];
  }
  const double white =
      white_light(projector, {channel_light(projector, 0, code[0]), channel_light(projector, 1, code[1]),
                              channel_light(projector, 2, code[2])});
  for (const RoomColour& primary : truth_.projectors[projector].primaries) {
    for (std::size_t r = 0; r < 3; ++r) colour[r] += white * primary[r];
  }
  return colour;
}

InterReflection::Light TrueMuseum::direct_light(std::size_t projector, const RgbImage& picture) const {
  InterReflection::Light light(cells_.count());
  if (!inter_reflection_ || picture.empty()) return light;
  const auto& tables = light_of_code_[projector];
  const ColourMatrix& primaries = truth_.projectors[projector].primaries;
  const int across = blocks(picture.width());
  std::vector<RoomColour> sums(static_cast<std::size_t>(across));
  for (int by = 0; by < blocks(picture.height()); ++by) {
    std::fill(sums.begin(), sums.end(), RoomColour{});
    for (int y = by * kBlock; y < std::min((by + 1) * kBlock, picture.height()); ++y) {
      const std::uint8_t* code = picture.at(0, y);
      for (int x = 0; x < picture.width(); ++x, code += 3) {
        RoomColour& sum = sums[static_cast<std::size_t>(x / kBlock)];
        const std::array<double, 3> shown{tables[0][code[0]], tables[1][code[1]], tables[2][code[2]]};
        const double white = white_light(projector, shown);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += shown[c] + white;
      }
    }
    for (int bx = 0; bx < across; ++bx) {
      const Deposit& deposit = deposits_[projector][static_cast<std::size_t>(by * across + bx)];
      if (!(deposit.flux_lm > 0.0)) continue;
      for (std::size_t r = 0; r < 3; ++r) {
        double flux = 0.0;
        for (std::size_t c = 0; c < 3; ++c) flux += sums[static_cast<std::size_t>(bx)][c] * primaries[c][r];
        for (std::size_t k = 0; k < 4; ++k)
          light[deposit.share.cells[k]][r] += flux * deposit.flux_lm * deposit.share.weights[k];
      }
    }
  }
  for (std::size_t i = 0; i < light.size(); ++i) {
    for (double& lux : light[i]) lux /= inter_reflection_->areas_m2()[i];
  }
  return light;
}

RoomColour TrueMuseum::radiance_at(const TrueWall::Hit& at, std::span<const RgbImage> pictures) const {
  CHECK(pictures.size() == truth_.projectors.size());
  RoomColour lux = truth_.ambient_lux;
  InterReflection::Light cells(cells_.count(), truth_.ambient_lux);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const RgbImage& picture = pictures[i];
    if (picture.empty()) continue;
    const auto direct = direct_light(i, picture);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      for (std::size_t r = 0; r < 3; ++r) cells[k][r] += direct[k][r];
    }
    const auto pixel = projector_pixel(i, at);
    if (!pixel || !truth_.projectors[i].lens.pinhole().contains(*pixel)) continue;
    const double gain = gain_lux(i, at);
    const double x = std::clamp(pixel->x() - 0.5, 0.0, picture.width() - 1.0);
    const double y = std::clamp(pixel->y() - 0.5, 0.0, picture.height() - 1.0);
    const int x0 = std::min(static_cast<int>(x), std::max(picture.width() - 2, 0));
    const int y0 = std::min(static_cast<int>(y), std::max(picture.height() - 2, 0));
    for (int corner = 0; corner < 4; ++corner) {
      const int xi = std::min(x0 + corner % 2, picture.width() - 1);
      const int yi = std::min(y0 + corner / 2, picture.height() - 1);
      const double weight = (corner % 2 == 0 ? 1.0 - (x - x0) : x - x0) * (corner / 2 == 0 ? 1.0 - (y - y0) : y - y0);
      const std::uint8_t* code = picture.at(xi, yi);
      const RoomColour colour = colour_of(i, {code[0], code[1], code[2]});
      for (std::size_t r = 0; r < 3; ++r) lux[r] += gain * weight * colour[r];
    }
  }
  if (inter_reflection_) {
    const auto indirect = inter_reflection_->indirect(cells);
    const WallCells::Share share = cells_.share(at.position);
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t r = 0; r < 3; ++r) lux[r] += share.weights[k] * indirect[share.cells[k]][r];
    }
  }
  const double paint = truth_.paint.is_plain() ? 1.0 : truth_.paint.albedo_at(at);
  for (std::size_t r = 0; r < 3; ++r) lux[r] *= paint * truth_.albedo[r] / std::numbers::pi;
  return lux;
}

RigidTransform<frame::Room, frame::Camera> TrueMuseum::camera_pose(double true_angle_rad) const {
  const RigidTransform<frame::Turntable, frame::Turntable> turned(
      Eigen::Quaterniond(Eigen::AngleAxisd(-true_angle_rad, Eigen::Vector3d::UnitY())), Eigen::Vector3d::Zero());
  return truth_.turntable.T_room_turntable * turned * truth_.turntable.T_turntable_camera;
}

Point<frame::Room> TrueMuseum::turning_point() const {
  const Eigen::Vector3d camera = truth_.turntable.T_turntable_camera.translation();
  return truth_.turntable.T_room_turntable * Point<frame::Turntable>{Eigen::Vector3d(0.0, camera.y(), 0.0)};
}

}  // namespace cyclorama::simulated
