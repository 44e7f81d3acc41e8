// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/flaws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"
#include "drivers/simulated/museum/true_sensor.h"

namespace cyclorama::simulated {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Quaterniond small_turn(RandomStream* draws, double max_rad) {
  const double x = draws->about_zero(max_rad);
  const double y = draws->about_zero(max_rad);
  const double z = draws->about_zero(max_rad);
  const Eigen::Vector3d turn(x, y, z);
  const double angle = turn.norm();
  if (!(angle > 0.0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

Eigen::Vector3d small_step(RandomStream* draws, double max_m) {
  const double x = draws->about_zero(max_m);
  const double y = draws->about_zero(max_m);
  return {x, y, draws->about_zero(max_m)};
}

void spoil_projector(RandomStream draws, TrueProjector* p) {
  Pinhole lens = p->lens.pinhole();
  lens.focal_px *= 1.0 + draws.about_zero(0.02);
  lens.centre_u_px += draws.about_zero(0.01) * lens.width_px;
  lens.centre_v_px += draws.about_zero(0.02) * lens.height_px;
  const double k1 = draws.between(-0.06, 0.03);
  const double k2 = draws.about_zero(0.02);
  const double p1 = draws.about_zero(0.001);
  p->lens = TrueLens(lens, {k1, k2, 0.0}, {p1, draws.about_zero(0.001)});
  const Eigen::Quaterniond turned = p->T_room_projector.rotation() * small_turn(&draws, 1.0 * kDegree);
  p->T_room_projector = {turned, p->T_room_projector.translation() + small_step(&draws, 0.04)};
  p->flux_lm = draws.between(2600.0, 3400.0);
  p->vignetting_exponent = draws.between(2.0, 5.0);
  const double gamma = draws.between(2.0, 2.4);
  for (std::size_t c = 0; c < 3; ++c) {
    p->response[c].gamma = gamma + draws.about_zero(0.08);
    p->response[c].bend = draws.between(-0.05, 0.12);
    p->black[c] = draws.between(1.0 / 3000.0, 1.0 / 1200.0);
    for (std::size_t r = 0; r < 3; ++r) {
      const double gain = r == c ? draws.between(0.9, 1.1) : 0.0;
      p->primaries[c][r] = gain + (r == c ? 0.0 : draws.between(0.0, 0.06));
    }
  }
  p->blur_px = draws.between(0.45, 0.8);
  p->defocus_px_per_dioptre = draws.between(4.0, 12.0);
  p->focus_distance_m = draws.between(4.2, 5.0);
  p->latency_s = 0.05;
}

void spoil_camera(RandomStream draws, TrueCamera* c) {
  Pinhole lens = c->lens.pinhole();
  lens.focal_px *= 1.0 + draws.about_zero(0.02);
  lens.centre_u_px += draws.about_zero(0.01) * lens.width_px;
  lens.centre_v_px += draws.about_zero(0.01) * lens.height_px;
  const double k1 = draws.between(-0.15, -0.02);
  const double k2 = draws.between(0.0, 0.04);
  const double p1 = draws.about_zero(0.0008);
  c->lens = TrueLens(lens, {k1, k2, 0.0}, {p1, draws.about_zero(0.0008)});
  c->vignetting_exponent = draws.between(2.0, 4.0);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t r = 0; r < 3; ++r)
      c->sensitivity[i][r] = i == r ? draws.between(0.8, 1.0) : draws.between(0.02, 0.15);
  }
  c->has_shot_noise = true;
  c->read_noise_e = draws.between(3.0, 9.0);
  c->full_well_e = 10500.0;
  // A white wall fills about three quarters of the full well in a thirtieth of a second.
  c->electrons_per_nit_s = draws.between(2000.0, 3000.0);
  c->bits = draws.between(0.0, 1.0) < 0.5 ? 8 : 12;
  c->response.gamma = draws.between(0.8, 1.05);
  c->response.bend = draws.about_zero(0.05);
  c->pedestal = 0.01;
  c->blur_px = draws.between(0.3, 0.7);
  c->line_time_s = draws.between(8e-6, 20e-6);
}

void spoil_turntable(RandomStream draws, TrueTurntable* turntable) {
  const Eigen::Quaterniond leaning = small_turn(&draws, 0.4 * kDegree);
  turntable->T_room_turntable = {leaning * turntable->T_room_turntable.rotation(),
                                 turntable->T_room_turntable.translation() + small_step(&draws, 0.01)};
  const Eigen::Quaterniond turned = turntable->T_turntable_camera.rotation() * small_turn(&draws, 1.5 * kDegree);
  turntable->T_turntable_camera = {turned, turntable->T_turntable_camera.translation() + small_step(&draws, 0.02)};
  turntable->scale_error = draws.about_zero(5e-4);
  turntable->wobble_rad = draws.about_zero(0.03 * kDegree);
  turntable->backlash_rad = draws.between(0.0, 0.05 * kDegree);
  turntable->jitter_rad = draws.between(0.0, 0.01 * kDegree);
}

}  // namespace

RandomStream RandomStream::stream(std::string_view name) const {
  std::uint64_t state = mixed(state_ + 0x5bd1e995u);
  for (const char letter : name) state = mixed(state ^ static_cast<unsigned char>(letter));
  return RandomStream(state);
}

double RandomStream::between(double min, double max) {
  state_ += 0x9e3779b97f4a7c15u;
  return min + (max - min) * (static_cast<double>(mixed(state_) >> 11) * 0x1p-53);
}

void bend_wall(RandomStream draws, double min_m, double max_m, MuseumTruth* truth) {
  auto* wall = std::get_if<CylinderWall>(&truth->wall);
  CHECK(wall != nullptr);
  const double length = wall->radius_m * wall->arc_rad;
  // A wave about as long as the arc has most of its range on the wall, whatever its phase.
  const double wave = 2.0 * std::numbers::pi / (length * draws.between(1.0, 1.3));
  const double phase = draws.about_zero(std::numbers::pi);
  double lowest = 1.0;
  double highest = -1.0;
  constexpr int kSteps = 2000;
  for (int i = 0; i <= kSteps; ++i) {
    const double value = std::sin(wave * length * (static_cast<double>(i) / kSteps - 0.5) + phase);
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  // The wall is nearest to the axis where the deviation is highest, since the distance is the radius minus the
  // deviation.
  const double amplitude = (max_m - min_m) / (highest - lowest);
  wall->radius_m = min_m + amplitude * highest;
  // The ends of the arc must not move, and the wave's coordinate scales with the radius.
  const double longer = wall->radius_m * wall->arc_rad / length;
  truth->deviation.waves.push_back({amplitude, wave / longer, 0.0, phase});
}

void tilt_wall(RandomStream draws, MuseumTruth* truth) {
  const double towards = draws.about_zero(std::numbers::pi);
  const double by = draws.between(1.5, 4.0) * kDegree;
  const Eigen::Vector3d axis(std::cos(towards), 0.0, std::sin(towards));
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(by, axis));
  // The pivot is at eye height, so that the picture stays on the wall.
  const Eigen::Vector3d pivot(0.0, 1.6, 0.0);
  truth->T_room_wall = {turned, pivot - turned * pivot};
}

void dent_wall(RandomStream draws, MuseumTruth* truth) {
  for (int i = 0; i < 3; ++i) {
    const double towards = draws.about_zero(std::numbers::pi);
    const double length = draws.between(1.2, 4.0);
    const double wave = 2.0 * std::numbers::pi / length;
    const double height = draws.between(0.002, 0.008) * length;
    truth->deviation.waves.push_back(
        {std::min(height, 0.02), wave * std::cos(towards), wave * std::sin(towards), draws.about_zero(3.1)});
  }
  for (int i = 0; i < 6; ++i) {
    const double s = draws.about_zero(4.5);
    const double t = draws.about_zero(0.9);
    const double sigma = draws.between(0.2, 0.6);
    truth->deviation.bumps.push_back({draws.about_zero(0.03), s, t, sigma});
  }
}

void add_flaws(const RandomStream& draws, MuseumTruth* truth) {
  for (std::size_t i = 0; i < truth->projectors.size(); ++i)
    spoil_projector(draws.stream(fmt::format("projector {}", i)), &truth->projectors[i]);
  spoil_camera(draws.stream("camera"), &truth->camera);
  spoil_turntable(draws.stream("plate"), &truth->turntable);
  RandomStream paint = draws.stream("paint");
  const double grey = paint.between(0.5, 0.85);
  for (double& albedo : truth->albedo) albedo = grey * (1.0 + paint.about_zero(0.03));
  for (double& lux : truth->ambient_lux) lux = paint.between(0.2, 3.0);
  truth->surround_nits = 0.3;
}

}  // namespace cyclorama::simulated
