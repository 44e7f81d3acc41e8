// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>
#include <variant>

#include "common/base/check.h"
#include "drivers/simulated/museum/truth.h"

namespace cyclorama::simulated {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string list(const std::vector<double>& values) { return fmt::format("[{}]", fmt::join(values, ", ")); }
std::string list(const RoomColour& c) { return list(std::vector<double>(c.begin(), c.end())); }
std::string list(const Eigen::Vector3d& v) { return list(std::vector<double>{v.x(), v.y(), v.z()}); }
std::string list(const Eigen::Vector2d& v) { return list(std::vector<double>{v.x(), v.y()}); }
std::string list(const ColourMatrix& m) { return fmt::format("[{}, {}, {}]", list(m[0]), list(m[1]), list(m[2])); }

/// Keys are in the order of truth.cpp. Numbers are written with enough digits for an exact round trip.
struct Writer {
  std::string text;
  template <typename T>
  void key(const char* name, const T& value) {
    text += fmt::format("{} = {}\n", name, value);
  }
  void head(const std::string& name) { text += fmt::format("[{}]\n", name); }
  void item(const std::string& name) { text += fmt::format("[[{}]]\n", name); }

  template <typename To, typename From>
  void pose(const std::string& name, const RigidTransform<To, From>& T) {
    head(name);
    const Eigen::Quaterniond& q = T.rotation();
    key("rotation_wxyz", list(std::vector<double>{q.w(), q.x(), q.y(), q.z()}));
    key("translation_m", list(T.translation()));
  }
  void curve(const std::string& name, const TrueResponse& curve) {
    head(name);
    key("gamma", curve.gamma);
    key("bend", curve.bend);
    key("clip", curve.clip);
    key("dip", curve.dip);
  }
  void lens(const std::string& name, const TrueLens& lens) {
    head(name);
    const Pinhole& pinhole = lens.pinhole();
    key("width_px", pinhole.width_px);
    key("height_px", pinhole.height_px);
    key("focal_px", pinhole.focal_px);
    key("centre_px", list(std::vector<double>{pinhole.centre_u_px, pinhole.centre_v_px}));
    key("radial", list(RoomColour(lens.radial())));
    key("tangential", list(std::vector<double>{lens.tangential()[0], lens.tangential()[1]}));
    for (const LensWave& wave : lens.waves()) {
      item(name + ".wave");
      key("shift_px", list(wave.shift_px));
      key("rad_per_px", list(wave.rad_per_px));
      key("phase_rad", wave.phase_rad);
    }
  }
  void paint(const WallPaint& paint) {
    head("paint");
    key("plaster", paint.plaster);
    key("plaster_grain_m", paint.plaster_grain_m);
    key("sheen", paint.sheen);
    key("sheen_exponent", paint.sheen_exponent);
    for (const WallPaint::Seam& seam : paint.seams) {
      item("paint.seam");
      key("across", seam.across);
      key("width", seam.width);
      key("albedo", seam.albedo);
    }
    for (const WallPaint::Panel& panel : paint.panels) {
      item("paint.panel");
      key("left", panel.left);
      key("right", panel.right);
      key("low", panel.low);
      key("high", panel.high);
      key("albedo", panel.albedo);
      key("gloss", panel.gloss);
    }
  }
  void pipeline(const CameraPipeline& pipeline) {
    head("camera.pipeline");
    key("noise_reduction", pipeline.noise_reduction);
    key("sharpening", pipeline.sharpening);
    key("jpeg_quality", pipeline.jpeg_quality);
    key("auto_exposure", pipeline.auto_exposure);
  }

  void shape(const CylinderWall& wall) {
    CHECK(wall.centre_x_m == 0.0 && wall.centre_z_m == 0.0);
    head("wall");
    key("shape", "\"cylinder\"");
    key("radius_m", wall.radius_m);
    key("arc_deg", wall.arc_rad / kDegree);
    key("bottom_m", wall.bottom_m);
    key("top_m", wall.top_m);
  }
  void shape(const DomeWall& wall) {
    head("wall");
    key("shape", "\"dome\"");
    key("centre_m", list(wall.centre.xyz));
    key("radius_m", wall.radius_m);
    key("field_deg", wall.field_rad / kDegree);
    key("tilt_deg", wall.tilt_rad / kDegree);
  }
  void shape(const PlanesWall& wall) {
    head("wall");
    key("shape", "\"planes\"");
    for (const WallRectangle& r : wall.rectangles) {
      item("wall.plane");
      key("centre_m", list(r.middle.xyz));
      // Inverse of WallRectangle::facing().
      key("pan_deg", std::atan2(r.right.z(), r.right.x()) / kDegree);
      key("tilt_deg", std::atan2(-r.normal().y(), r.up.y()) / kDegree);
      key("width_m", r.width_m);
      key("height_m", r.height_m);
    }
  }
  void shape(const MeshWall&) { CHECK(!"a truth has no mesh"); }

  void projector(const TrueProjector& p) {
    item("projector");
    key("flux_lm", p.flux_lm);
    key("vignetting_exponent", p.vignetting_exponent);
    key("primaries", list(p.primaries));
    key("black", list(p.black));
    key("blur_px", p.blur_px);
    key("focus_distance_m", p.focus_distance_m);
    key("defocus_px_per_dioptre", p.defocus_px_per_dioptre);
    key("latency_s", p.latency_s);
    key("lateral_colour", list(Eigen::Vector2d(p.lateral_colour[0], p.lateral_colour[1])));
    key("white_segment", p.white_segment);
    key("drift_px", list(p.drift_px));
    key("warm_up_s", p.warm_up_s);
    lens("projector.lens", p.lens);
    pose("projector.pose", p.T_room_projector);
    curve("projector.red", p.response[0]);
    curve("projector.green", p.response[1]);
    curve("projector.blue", p.response[2]);
  }
  void camera(const TrueCamera& c) {
    head("camera");
    key("vignetting_exponent", c.vignetting_exponent);
    key("sensitivity", list(c.sensitivity));
    key("grey_sensitivity", list(c.grey_sensitivity));
    key("electrons_per_nit_s", c.electrons_per_nit_s);
    key("full_well_e", c.full_well_e);
    key("read_noise_e", c.read_noise_e);
    key("has_shot_noise", c.has_shot_noise);
    key("bits", c.bits);
    key("pedestal", c.pedestal);
    key("blur_px", c.blur_px);
    key("line_time_s", c.line_time_s);
    lens("camera.lens", c.lens);
    curve("camera.response", c.response);
    pipeline(c.pipeline);
  }
  void turntable(const TrueTurntable& p) {
    head("turntable");
    key("scale_error", p.scale_error);
    key("wobble_rad", p.wobble_rad);
    key("backlash_rad", p.backlash_rad);
    key("jitter_rad", p.jitter_rad);
    key("speed_rad_s", p.speed_rad_s);
    key("creep_px_per_h", list(p.creep_px_per_h));
    key("vibration_px", p.vibration_px);
    pose("turntable.axis", p.T_room_turntable);
    pose("turntable.camera", p.T_turntable_camera);
  }
};

}  // namespace

std::string MuseumTruth::text() const {
  Writer writer;
  writer.text = "# What a simulated museum really is. For the simulation and for scoring only.\n";
  writer.key("seed", seed);
  writer.key("albedo", list(albedo));
  writer.key("ambient_lux", list(ambient_lux));
  writer.key("daylight_lux", list(daylight_lux));
  writer.key("daylight_period_s", daylight_period_s);
  writer.key("surround_nits", surround_nits);
  writer.key("cells", cells);
  std::visit([&](const auto& shape) { writer.shape(shape); }, wall);
  writer.pose("wall_pose", T_room_wall);
  for (const WallDeviation::Wave& wave : deviation.waves) {
    writer.item("deviation.wave");
    writer.key("height_m", wave.height_m);
    writer.key("s_rad_per_m", wave.s_rad_per_m);
    writer.key("t_rad_per_m", wave.t_rad_per_m);
    writer.key("phase_rad", wave.phase_rad);
  }
  for (const WallDeviation::Bump& bump : deviation.bumps) {
    writer.item("deviation.bump");
    writer.key("height_m", bump.height_m);
    writer.key("s_m", bump.s_m);
    writer.key("t_m", bump.t_m);
    writer.key("sigma_m", bump.sigma_m);
  }
  writer.paint(paint);
  for (const TrueProjector& projector : projectors) writer.projector(projector);
  writer.camera(camera);
  writer.turntable(turntable);
  return writer.text;
}

}  // namespace cyclorama::simulated
