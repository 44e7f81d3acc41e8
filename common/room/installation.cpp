// SPDX-License-Identifier: Apache-2.0
#include "common/room/installation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/file.h"
#include "common/config/config.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Range kMetres{-100.0, 100.0};
constexpr Range kAngles{-360.0, 360.0};

Point<frame::Room> point_of(const std::vector<double>& xyz) { return {Eigen::Vector3d(xyz[0], xyz[1], xyz[2])}; }

/// pan to the right, then tilt upwards, then roll clockwise as seen from behind; at zero the lens looks along -z.
Eigen::Quaterniond aimed(double pan_rad, double tilt_rad, double roll_rad) {
  const Eigen::Quaterniond looking_ahead(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  return Eigen::AngleAxisd(-pan_rad, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()) *
         looking_ahead * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ());
}

bool is_inside(const CylinderWall& wall, const Point<frame::Room>& point) {
  return std::hypot(point.xyz.x() - wall.centre_x_m, point.xyz.z() - wall.centre_z_m) < wall.radius_m;
}

InstalledProjector read_projector(ConfigTable table, const CylinderWall& wall) {
  InstalledProjector projector;
  projector.name = table.text("name");
  const int width = table.integer("width_px", {16, 8192});
  const int height = table.integer("height_px", {16, 8192});
  projector.lens = Pinhole::from_field_of_view(width, height, table.number("field_of_view_deg", {1.0, 150.0}) * kDegree);
  const std::vector<double> shift = table.numbers("lens_shift_fraction", 2, {-1.0, 1.0}, std::vector<double>{0.0, 0.0});
  projector.lens.centre_u_px += shift[0] * width;
  projector.lens.centre_v_px += shift[1] * height;
  const Point<frame::Room> position = point_of(table.numbers("position_m", 3, kMetres));
  const double pan = table.number("pan_deg", kAngles, 0.0) * kDegree;
  const double tilt = table.number("tilt_deg", kAngles, 0.0) * kDegree;
  const double roll = table.number("roll_deg", kAngles, 0.0) * kDegree;
  projector.T_room_projector = {aimed(pan, tilt, roll), position.xyz};
  if (!is_inside(wall, position)) table.refuse("position_m", "is outside the wall; move the projector inside its radius");
  return projector;
}

}  // namespace

Panorama Installation::panorama(int width_px) const {
  double widest = 0.0;
  double top = -std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
  constexpr int kSteps = 256;
  for (int i = 0; i <= kSteps; ++i) {
    const double arc_angle = wall.arc_rad * (static_cast<double>(i) / kSteps - 0.5);
    for (const double height : {wall.bottom_m, wall.top_m}) {
      const Eigen::Vector3d d = wall.point_at(arc_angle, height).xyz - sweet_spot.xyz;
      widest = std::max(widest, std::abs(std::atan2(d.x(), -d.z())));
      const double tan_elevation = d.y() / std::hypot(d.x(), d.z());
      top = std::max(top, tan_elevation);
      bottom = std::min(bottom, tan_elevation);
    }
  }
  Panorama panorama;
  panorama.width_px = width_px;
  panorama.azimuth_span_rad = std::min(2.0 * widest, 2.0 * std::numbers::pi);
  panorama.tan_elevation_top = top;
  panorama.tan_elevation_bottom = bottom;
  panorama.height_px = std::max(1, static_cast<int>(std::lround((top - bottom) / panorama.radians_per_px())));
  return panorama;
}

Result<Installation> parse_installation(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  ConfigTable root = config.root();
  Installation installation;
  installation.name = root.text("name");

  ConfigTable wall = root.table("wall");
  wall.choice("shape", {"cylinder"}, "cylinder");
  installation.wall.radius_m = wall.number("radius_m", {0.5, 50.0});
  installation.wall.arc_rad = wall.number("arc_deg", {2.0, 360.0}) * kDegree;
  installation.wall.bottom_m = wall.number("bottom_m", {-10.0, 50.0}, 0.0);
  installation.wall.top_m = wall.number("top_m", {-10.0, 50.0});
  if (!(installation.wall.top_m > installation.wall.bottom_m)) wall.refuse("top_m", "must be above bottom_m");

  ConfigTable visitor = root.table("visitor");
  installation.sweet_spot = point_of(visitor.numbers("eye_m", 3, kMetres));
  if (!is_inside(installation.wall, installation.sweet_spot)) {
    visitor.refuse("eye_m", "is outside the wall; the sweet spot lies inside its radius");
  }

  for (ConfigTable& table : root.tables("projector")) {
    installation.projectors.push_back(read_projector(table, installation.wall));
    const std::string& added = installation.projectors.back().name;
    const auto same = [&](const InstalledProjector& p) { return p.name == added; };
    if (std::count_if(installation.projectors.begin(), installation.projectors.end(), same) > 1) {
      table.refuse("name", fmt::format("'{}' is the name of another projector too; rename one", added));
    }
  }
  if (installation.projectors.empty()) root.refuse("projector", "add at least one [[projector]]");
  TRY(config.finish());
  return installation;
}

Result<Installation> read_installation(const std::filesystem::path& path) {
  TRY_ASSIGN(const std::string text, read_text_file(path, std::size_t{1} << 20));
  return parse_installation(text, path.string());
}

}  // namespace cyclorama
