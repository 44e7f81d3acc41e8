// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/as_sold.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama::simulated {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Sizes in pixels are those of pictures with 1080 rows, and scale with the rows.
double pixels(const TrueLens& lens) { return lens.pinhole().height_px / 1080.0; }

TrueLens with_waves(RandomStream draws, const TrueLens& lens, double largest_px) {
  std::vector<LensWave> waves;
  constexpr int kWaves = 4;
  for (int i = 0; i < kWaves; ++i) {
    // From one to three waves over the picture's height: no polynomial of low degree follows them.
    const double towards = draws.about_zero(std::numbers::pi);
    const double rad_per_px = kTurn * draws.between(1.0, 3.0) / lens.pinhole().height_px;
    const double shift_towards = draws.about_zero(std::numbers::pi);
    const double shift_px = largest_px / kWaves * draws.between(0.7, 1.0);
    waves.push_back({shift_px * Eigen::Vector2d(std::cos(shift_towards), std::sin(shift_towards)),
                     rad_per_px * Eigen::Vector2d(std::cos(towards), std::sin(towards)),
                     draws.about_zero(std::numbers::pi)});
  }
  return TrueLens(lens.pinhole(), lens.radial(), lens.tangential(), std::move(waves));
}

void decentre(const RandomStream& of_kind, MuseumTruth* truth) {
  RandomStream draws = of_kind;
  for (TrueProjector& p : truth->projectors) {
    Pinhole pinhole = p.lens.pinhole();
    pinhole.centre_u_px += draws.about_zero(0.02) * pinhole.width_px;
    pinhole.centre_v_px += draws.about_zero(0.02) * pinhole.height_px;
    const double p1 = draws.about_zero(0.003);
    p.lens = TrueLens(pinhole, p.lens.radial(), {p1, draws.about_zero(0.003)}, p.lens.waves());
  }
}

void leave_residue(const RandomStream& draws, MuseumTruth* truth) {
  int number = 0;
  for (TrueProjector& p : truth->projectors)
    p.lens = with_waves(draws.stream(fmt::format("lens {}", number++)), p.lens, 0.6 * pixels(p.lens));
  truth->camera.lens = with_waves(draws.stream("camera"), truth->camera.lens, 0.3 * pixels(truth->camera.lens));
}

void colour_rims(const RandomStream& of_kind, MuseumTruth* truth) {
  RandomStream draws = of_kind;
  for (TrueProjector& p : truth->projectors) {
    const double rim = 0.5 * std::hypot(p.lens.pinhole().width_px, p.lens.pinhole().height_px);
    const double largest = 0.5 * pixels(p.lens) / rim;
    p.lateral_colour = {draws.between(0.5, 1.0) * largest, -draws.between(0.5, 1.0) * largest};
  }
}

void defocus(const RandomStream& of_kind, MuseumTruth* truth) {
  RandomStream draws = of_kind;
  for (TrueProjector& p : truth->projectors) {
    p.focus_distance_m = draws.between(3.6, 4.2);
    // A wall that is half a metre nearer beside the middle is .03 to .04 dioptres out of focus.
    p.defocus_px_per_dioptre = draws.between(20.0, 40.0) * pixels(p.lens);
  }
}

void turn_wheel(const RandomStream& of_kind, MuseumTruth* truth) {
  RandomStream draws = of_kind;
  for (TrueProjector& p : truth->projectors) {
    const double gamma = draws.between(2.2, 2.6);
    for (TrueResponse& response : p.response) response.gamma = gamma * (1.0 + draws.about_zero(0.02));
    p.white_segment = draws.between(0.3, 0.6);
  }
}

void warm_up(const RandomStream& of_kind, MuseumTruth* truth) {
  RandomStream draws = of_kind;
  for (TrueProjector& p : truth->projectors) {
    const double towards = draws.about_zero(std::numbers::pi);
    p.drift_px = 0.5 * pixels(p.lens) * Eigen::Vector2d(std::cos(towards), std::sin(towards));
    p.warm_up_s = 600.0;
  }
}

void make_webcam(const RandomStream& of_kind, MuseumTruth* truth) {
  RandomStream draws = of_kind;
  TrueCamera& c = truth->camera;
  c.bits = 8;
  c.response.gamma = 0.45;
  c.response.bend = draws.between(0.05, 0.15);
  c.pedestal = 0.002;
  c.line_time_s = 30e-6;
  c.pipeline.noise_reduction = 0.6;
  c.pipeline.sharpening = 0.7;
  c.pipeline.jpeg_quality = 80;
}

void paint_wall(const RandomStream& of_kind, MuseumTruth* truth) {
  RandomStream draws = of_kind;
  for (int i = 0; i < 3; ++i)
    truth->paint.seams.push_back({draws.between(0.05, 0.95), 0.0015, draws.between(0.7, 0.9)});
  const double left = draws.between(0.1, 0.8);
  truth->paint.panels.push_back({left, left + 0.09, 0.0, 0.85, draws.between(0.6, 0.8), 0.3});
  truth->paint.plaster = 0.06;
  truth->paint.sheen = 0.1;
}

void expose_freely(const RandomStream&, MuseumTruth* truth) { truth->camera.pipeline.auto_exposure = 0.4; }
void let_daylight_in(const RandomStream&, MuseumTruth* truth) { truth->daylight_lux = {20.0, 21.0, 23.0}; }

void loosen_mount(const RandomStream&, MuseumTruth* truth) {
  truth->turntable.creep_px_per_h = {6.0, -4.0};
  truth->turntable.vibration_px = 0.1;
}

struct Kind {
  const char* name;
  void (*add)(const RandomStream& draws, MuseumTruth* truth);
};
constexpr Kind kKinds[] = {{"decentred", decentre}, {"residue", leave_residue},
                           {"colour", colour_rims}, {"focus", defocus},
                           {"wheel", turn_wheel},   {"drift", warm_up},
                           {"webcam", make_webcam}, {"exposure", expose_freely},
                           {"wall", paint_wall},    {"daylight", let_daylight_in},
                           {"mount", loosen_mount}};

}  // namespace

const std::vector<std::string>& as_sold_kinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Kind& kind : kKinds) list.emplace_back(kind.name);
    return list;
  }();
  return names;
}

Status add_as_sold(const RandomStream& draws, std::string_view kind, MuseumTruth* truth) {
  const auto* const found = std::ranges::find(kKinds, kind, &Kind::name);
  if (found == std::end(kKinds)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("nothing as sold is called '{}'; there are {}", kind, fmt::join(as_sold_kinds(), ", ")));
  }
  found->add(draws.stream(kind), truth);
  return Done{};
}

}  // namespace cyclorama::simulated
