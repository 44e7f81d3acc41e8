// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/scene_package.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <system_error>

#include "common/base/text.h"
#include "common/config/config.h"
#include "renderfarm/scene/area.h"
#include "renderfarm/scene/lamp_groups.h"

namespace cyclorama::scene {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Range kMetres{-1e6, 1e6};
constexpr Range kAngle{-360.0, 360.0};
constexpr Range kLight{0.0, 1e9};
constexpr Range kLampSize{1e-6, 1e4};
constexpr Range kUnit{1e-6, 1e6};
constexpr Range kScale{1e-6, 1e6};
constexpr std::size_t kMaxCorners = 1024;  // Limit of the code that moves the visitor.

Eigen::Vector3d vector_of(const std::vector<double>& xyz) { return {xyz[0], xyz[1], xyz[2]}; }

Eigen::Vector3f colour_of(const std::vector<double>& rgb) { return vector_of(rgb).cast<float>(); }

Eigen::Vector3d position(ConfigTable* table) {
  return vector_of(table->numbers("position_m", 3, kMetres, std::vector<double>{0.0, 0.0, 0.0}));
}

std::optional<Eigen::Vector3f> colour_if_given(ConfigTable* table, const char* key) {
  if (!table->has(key)) return std::nullopt;
  return colour_of(table->numbers(key, 3, kLight));
}

std::optional<double> number_if_given(ConfigTable* table, const char* key, Range range) {
  if (!table->has(key)) return std::nullopt;
  return table->number(key, range);
}

/// Returns the path of a file in the package. Files outside are refused, because an untrusted package could otherwise
/// read other files of this machine.
std::filesystem::path file_inside(ConfigTable* table, const std::filesystem::path& folder) {
  const std::string file = table->text("file");
  std::error_code error;
  const std::filesystem::path base = std::filesystem::weakly_canonical(folder, error);
  const std::filesystem::path whole = std::filesystem::weakly_canonical(base / file, error);
  const std::filesystem::path relative = whole.lexically_relative(base);
  if (error || file.empty() || relative.empty() || *relative.begin() == "..") {
    table->refuse("file", fmt::format("'{}' is not inside the package's folder; copy it there", printable(file)));
  } else if (!std::filesystem::is_regular_file(whole, error)) {
    table->refuse("file",
                  fmt::format("'{}' is not a file of the package; add it, or correct the name", printable(file)));
  }
  return whole;
}

Eigen::Affine3d rotation_of(const std::vector<double>& xyz_deg) {
  Eigen::Affine3d rotation = Eigen::Affine3d::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    const double angle = xyz_deg[static_cast<std::size_t>(axis)] * kDegree;
    rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)) * rotation;
  }
  return rotation;
}

/// Returns a placement at `at`. A heading turns to the right, which is clockwise seen from above.
Eigen::Affine3d standing_at(const Eigen::Vector3d& at, double heading_rad, double scale) {
  return Eigen::Translation3d(at) * Eigen::AngleAxisd(-heading_rad, Eigen::Vector3d::UnitY()) * Eigen::Scaling(scale);
}

bool is_z_up(ConfigTable* table, bool fallback) { return table->choice("up", {"y", "z"}, fallback ? "z" : "y") == "z"; }

PackageGeometry read_geometry(ConfigTable table, const std::filesystem::path& folder, double unit_m, bool z_up) {
  PackageGeometry geometry;
  geometry.file = file_inside(&table, folder);
  geometry.unit_m = table.number("unit_m", kUnit, unit_m);
  geometry.z_up = is_z_up(&table, z_up);
  const Eigen::Affine3d rotation =
      rotation_of(table.numbers("rotation_deg", 3, kAngle, std::vector<double>{0.0, 0.0, 0.0}));
  const Eigen::Affine3d placed =
      Eigen::Translation3d(position(&table)) * rotation * Eigen::Scaling(table.number("scale", kScale, 1.0));
  for (ConfigTable& instance : table.tables("instance")) {
    const Eigen::Vector3d at = position(&instance);
    const double heading = instance.number("heading_deg", kAngle, 0.0) * kDegree;
    geometry.T_scene_part.push_back(standing_at(at, heading, instance.number("scale", kScale, 1.0)) * placed);
  }
  if (geometry.T_scene_part.empty()) geometry.T_scene_part.push_back(placed);
  return geometry;
}

void read_cone(ConfigTable* table, Light* light) {
  light->inner_cone_rad = table->number("inner_cone_deg", {0.0, 90.0}, 0.0) * kDegree;
  light->outer_cone_rad = table->number("outer_cone_deg", {0.1, 90.0}, 45.0) * kDegree;
  if (light->inner_cone_rad >= light->outer_cone_rad) {
    table->refuse("inner_cone_deg", "must be below outer_cone_deg; both are measured from the axis");
  }
}

void read_direction(ConfigTable* table, Light* light) {
  const Eigen::Vector3d direction =
      vector_of(table->numbers("direction", 3, kMetres, std::vector<double>{0.0, -1.0, 0.0}));
  if (direction.norm() > 1e-9) {
    light->direction = direction.normalized();
  } else {
    table->refuse("direction", "has no length; give a vector that points where the lamp shines");
  }
}

/// Returns the direction of a rectangle's width: level, as for a picture on a wall, then rotated about `direction`.
Eigen::Vector3d across_of(const Eigen::Vector3d& direction, double rotation_rad) {
  Eigen::Vector3d level = direction.cross(Eigen::Vector3d::UnitY());
  level = level.norm() > 1e-9 ? level.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  return Eigen::AngleAxisd(rotation_rad, direction) * level;
}

/// Reads the radiance of a rectangle or disk. Precondition: the lamp's size has been read.
Eigen::Vector3f read_radiance(ConfigTable* table, const Light& light) {
  if (table->has("luminance_nits") && table->has("flux_lm")) {
    table->refuse("flux_lm", "repeats luminance_nits; keep one of them");
  }
  if (!table->has("flux_lm")) return colour_of(table->numbers("luminance_nits", 3, kLight));
  const double lumen_per_nit = std::numbers::pi * area_of(light);
  const Eigen::Vector3d flux = vector_of(table->numbers("flux_lm", 3, kLight));
  return lumen_per_nit > 0.0 ? Eigen::Vector3f((flux / lumen_per_nit).cast<float>()) : Eigen::Vector3f::Zero().eval();
}

void read_flat_lamp(ConfigTable* table, Light* light) {
  light->position = vector_of(table->numbers("position_m", 3, kMetres));
  read_direction(table, light);
  if (light->kind == LightKind::kRectangle) {
    const std::vector<double> size = table->numbers("size_m", 2, kLampSize);
    light->size_m = {size[0], size[1]};
    light->across = across_of(light->direction, table->number("rotation_deg", kAngle, 0.0) * kDegree);
  } else {
    light->radius_m = table->number("radius_m", kLampSize);
  }
  light->intensity = read_radiance(table, *light);
  light->visible = table->flag("visible", true);
}

Light read_lamp(ConfigTable table) {
  Light light;
  light.name = table.text("name", "");
  const std::string kind = table.choice("kind", {"point", "spot", "directional", "rectangle", "disk"});
  if (kind == "rectangle" || kind == "disk") {
    light.kind = kind == "disk" ? LightKind::kDisk : LightKind::kRectangle;
    read_flat_lamp(&table, &light);
    return light;
  }
  if (kind == "directional") {
    light.kind = LightKind::kDirectional;
    light.intensity = colour_of(table.numbers("intensity_lux", 3, kLight));
    light.radius_m = std::tan(table.number("angular_radius_deg", {0.0, 45.0}, 0.0) * kDegree);
  } else {
    light.kind = kind == "spot" ? LightKind::kSpot : LightKind::kPoint;
    light.position = vector_of(table.numbers("position_m", 3, kMetres));
    light.intensity = colour_of(table.numbers("intensity_cd", 3, kLight));
    light.radius_m = table.number("radius_m", {0.0, 1000.0}, 0.0);
    light.range_m = table.number("range_m", {0.0, 1e6}, 0.0);
    light.visible = table.flag("visible", false);
    if (light.visible && !(light.radius_m > 0.0)) {
      table.refuse("visible", "cannot be seen without a size; give radius_m as well");
    }
  }
  if (light.kind != LightKind::kPoint) read_direction(&table, &light);
  if (light.kind == LightKind::kSpot) read_cone(&table, &light);
  return light;
}

/// Returns the group that a lamp names, which is added to `names` if it is new; 0 if it names none.
std::size_t read_group(ConfigTable* lamp, std::vector<std::string>* names) {
  if (!lamp->has("group")) return 0;
  const std::string name = lamp->text("group");
  if (name.empty() || name.size() > kMaxLampGroupNameBytes) {
    lamp->refuse("group", fmt::format("must have 1 to {} bytes", kMaxLampGroupNameBytes));
    return 0;
  }
  const auto known = std::ranges::find(*names, name);
  if (known == names->end()) {
    if (names->size() + 1 == kMaxLampGroups) {
      lamp->refuse("group",
                   fmt::format("is the {}th group of lamps; there may be {}, since the light of each is stored",
                               kMaxLampGroups, kMaxLampGroups - 1));
      return 0;
    }
    names->push_back(name);
    return names->size();
  }
  return static_cast<std::size_t>(known - names->begin()) + 1;
}

std::optional<Sky> read_sky(ConfigTable* root) {
  if (!root->has("sky")) return std::nullopt;
  ConfigTable table = root->table("sky");
  const std::vector<double> none{0.0, 0.0, 0.0};
  return Sky{colour_of(table.numbers("zenith", 3, kLight, none)), colour_of(table.numbers("horizon", 3, kLight, none)),
             colour_of(table.numbers("ground", 3, kLight, none))};
}

ToneCurve read_tone(ConfigTable table) {
  const std::string curve = table.choice("curve", {"shoulder", "linear", "filmic"}, "shoulder");
  return curve == "linear" ? ToneCurve::kLinear : curve == "filmic" ? ToneCurve::kFilmic : ToneCurve::kShoulder;
}

std::optional<PackageEnvironment> environment_if_given(ConfigTable* root, const std::filesystem::path& folder) {
  if (!root->has("environment")) return std::nullopt;
  ConfigTable table = root->table("environment");
  if (root->has("sky")) table.refuse("file", "takes the place of [sky]; remove one of them");
  PackageEnvironment environment;
  environment.file = file_inside(&table, folder);
  environment.strength = static_cast<float>(table.number("strength", kLight, 1.0));
  environment.rotation_rad = static_cast<float>(table.number("rotation_deg", kAngle, 0.0) * kDegree);
  return environment;
}

/// Reads the holes of the walkable area. Returns the number of corners of the area and its holes.
std::size_t read_holes(ConfigTable* visitor, ScenePackage* package) {
  std::size_t corners = package->walkable.size();
  for (ConfigTable& hole : visitor->tables("hole")) {
    std::vector<Eigen::Vector2d>& polygon = package->walkable_holes.emplace_back();
    for (const std::vector<double>& corner : hole.points("corners_m", 2, kMetres)) {
      polygon.emplace_back(corner[0], corner[1]);
    }
    corners += polygon.size();
    if (!(area_of(polygon) > 0.0)) {
      hole.refuse("corners_m", "must be the [x, z] corners of what is in the way: three or more, not all on a line");
    } else if (package->walkable.empty()) {
      hole.refuse("corners_m", "is a hole without an area; give walkable_m as well");
    }
  }
  return corners;
}

bool may_stand(const ScenePackage& package, const Eigen::Vector2d& place) {
  const auto holds = [&](const std::vector<Eigen::Vector2d>& polygon) { return is_inside(polygon, place); };
  return holds(package.walkable) && std::none_of(package.walkable_holes.begin(), package.walkable_holes.end(), holds);
}

void read_visitor(ConfigTable table, ScenePackage* package) {
  package->eye_height_m = number_if_given(&table, "eye_height_m", {0.01, 100.0});
  package->walking_scale = number_if_given(&table, "walking_scale", {1e-4, 1e4});
  for (const std::vector<double>& corner : table.points("walkable_m", 2, kMetres)) {
    package->walkable.emplace_back(corner[0], corner[1]);
  }
  const std::size_t corners = read_holes(&table, package);
  if (corners > kMaxCorners) {
    table.refuse("walkable_m",
                 fmt::format("has {} corners with its holes; at most {} are accepted", corners, kMaxCorners));
  } else if (table.has("walkable_m") && !(area_of(package->walkable) > 0.0)) {
    table.refuse("walkable_m", "must be the [x, z] corners of an area: three or more, not all on a line");
  } else if (table.has("walkable_m") && !package->start_eye) {
    table.refuse("walkable_m", "needs a place to start in it; give [start] eye_m as well");
  } else if (package->start_eye && !package->walkable.empty() &&
             !may_stand(*package, {package->start_eye->x(), package->start_eye->z()})) {
    table.refuse("walkable_m", "does not hold the start: [start] eye_m is outside of walkable_m; move one of them");
  }
}

}  // namespace

Result<ScenePackage> parse_scene_package(std::string_view text, std::string name, const std::filesystem::path& folder) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  ConfigTable root = config.root();
  ScenePackage package;
  package.title = root.text("title");
  package.credits = root.text("credits", "");
  package.repair = root.flag("repair", false);
  const double unit_m = root.number("unit_m", kUnit, 1.0);
  const bool z_up = is_z_up(&root, false);
  package.exposure = number_if_given(&root, "exposure", {1e-6, 1e6});
  package.tone = read_tone(root.table("tone"));
  package.bounces = root.integer("bounces", {0, kMaxSceneBounces}, kUsualBounces);

  ConfigTable start = root.table("start");
  if (start.has("eye_m")) package.start_eye = vector_of(start.numbers("eye_m", 3, kMetres));
  if (const auto heading = number_if_given(&start, "heading_deg", kAngle))
    package.start_heading_rad = *heading * kDegree;
  read_visitor(root.table("visitor"), &package);
  package.sky = read_sky(&root);
  package.environment = environment_if_given(&root, folder);
  ConfigTable light = root.table("light");
  package.ambient = colour_if_given(&light, "ambient");
  package.eye_lamp = colour_if_given(&light, "eye_lamp_cd");

  for (ConfigTable& lamp : root.tables("lamp")) {
    package.lamps.push_back(read_lamp(lamp));
    package.lamps.back().group = read_group(&lamp, &package.lamp_groups);
  }
  for (ConfigTable& geometry : root.tables("geometry")) {
    package.geometry.push_back(read_geometry(geometry, folder, unit_m, z_up));
  }
  if (package.geometry.empty()) root.refuse("geometry", "add at least one [[geometry]] with its file");
  for (ConfigTable& stop : root.tables("stop")) {
    package.stops.push_back({stop.text("title"), vector_of(stop.numbers("eye_m", 3, kMetres)),
                             stop.number("heading_deg", kAngle, 0.0) * kDegree});
  }
  TRY(config.finish());
  return package;
}

}  // namespace cyclorama::scene
