// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/found_frame.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "renderfarm/scene/assemble.h"
#include "renderfarm/scene/facings.h"
#include "renderfarm/scene/found_settings.h"

namespace cyclorama::scene {
namespace {

constexpr double kMetresUpTo = 30.0;           ///< Length up to which files are taken to be in metres.
constexpr double kMillimetresBeyond = 2000.0;  ///< Larger than any site that a visitor walks through, in metres.
constexpr double kMinRoomM = 2.0;
constexpr double kMaxRoomM = 15.0;

void place_instances(const Eigen::Affine3d& T, Model* file) {
  for (Instance& instance : file->instances) instance.T_model_mesh = T * instance.T_model_mesh;
}

/// Returns the settings of the file, in metres, under the assumption that its unit is `unit_m`.
FoundSettings settings_in(double unit_m, const Eigen::AlignedBox3d& bounds, Model* file) {
  const std::vector<Instance> instances = file->instances;
  place_instances(Eigen::Affine3d(Eigen::Scaling(unit_m)), file);
  FoundSettings found = find_settings(*file, {bounds.min() * unit_m, bounds.max() * unit_m}, std::nullopt);
  file->instances = instances;
  return found;
}

bool has_usual_room(double unit_m, const Eigen::AlignedBox3d& bounds, Model* file) {
  const FoundSettings found = settings_in(unit_m, bounds, file);
  const double height = found.is_stage ? bounds.sizes().y() * unit_m : found.ceiling_m + found.eye_height_m;
  return (found.is_stage || found.kind == SceneKind::kRoom) && height >= kMinRoomM && height <= kMaxRoomM;
}

constexpr const char* kRemedy = "if it is not, make a scene package and set unit_m";

double unit_of(const Eigen::AlignedBox3d& bounds, Model* file, std::vector<std::string>* notes) {
  constexpr double kCentimetre = 0.01;
  constexpr double kMillimetre = 0.001;
  const double longest = bounds.sizes().maxCoeff();
  if (longest <= kMetresUpTo) return 1.0;
  const bool may_be_metres = longest <= kMillimetresBeyond;
  if (may_be_metres) {
    const FoundSettings found = settings_in(1.0, bounds, file);
    const double height = found.ceiling_m + found.eye_height_m;
    const bool is_usual = found.kind == SceneKind::kRoom && height <= kMaxRoomM;
    if (is_usual) return 1.0;
    if (!has_usual_room(kCentimetre, bounds, file)) {
      if (found.kind == SceneKind::kRoom) {
        notes->push_back(
            fmt::format("the start is in a room {:.0f} units high, which are taken as metres; {}", height, kRemedy));
      }
      if (found.kind == SceneKind::kObject) {
        notes->push_back(
            fmt::format("the object is {:.0f} units long, which looks like {}: it is shown whole in any "
                        "unit; to meet it in its own size, make a scene package and set unit_m",
                        longest, longest > 300.0 ? "millimetres" : "centimetres or millimetres"));
      }
      return 1.0;
    }
  } else if (has_usual_room(kMillimetre, bounds, file) || !has_usual_room(kCentimetre, bounds, file)) {
    notes->push_back(fmt::format("the file is {:.0f} units long: taken as millimetres; {}", longest, kRemedy));
    return kMillimetre;
  }
  notes->push_back(
      fmt::format("the file is {:.0f} units long: taken as centimetres, in which its rooms have a usual "
                  "height; {}",
                  longest, kRemedy));
  return kCentimetre;
}

/// Returns true for a thin object that lies on the ground and is too small to walk on.
bool lies_flat(const Eigen::Vector3d& size_m) {
  constexpr double kFlat = 0.1;
  constexpr double kMinSiteM = 6.0;
  const double narrower = std::min(size_m.x(), size_m.z());
  return size_m.y() < kFlat * narrower && narrower < kMinSiteM;
}

/// Returns true if the geometry ends at z = 0, as things do that stand on a floor there, and not at y = 0.
bool stands_on_z(const Eigen::AlignedBox3d& bounds) {
  constexpr double kTolerance = 0.005;
  const auto ends_at_0 = [&](Eigen::Index axis) {
    return std::abs(bounds.min()[axis]) <= kTolerance * bounds.sizes()[axis] && bounds.sizes()[axis] > 0.0;
  };
  return ends_at_0(2) && !ends_at_0(1);
}

}  // namespace

FoundFrame find_frame(Model* file, StatedFrame stated) {
  FoundFrame frame;
  Eigen::AlignedBox3d bounds = bounds_of(*file);
  if (bounds.isEmpty()) return frame;
  const bool is_z_up = stated == StatedFrame::kNothing && stands_on_z(bounds);
  const std::vector<Instance> instances = file->instances;
  if (is_z_up) {
    place_instances(T_part_file(1.0, true), file);
    bounds = bounds_of(*file);
    frame.notes.emplace_back(
        "the file stands on z = 0: z is taken as up; if it is not, make a scene package and set up");
  }
  if (stated != StatedFrame::kUpAndMetres) frame.unit_m = unit_of(bounds, file, &frame.notes);
  frame.T_scene_file = T_part_file(frame.unit_m, is_z_up);
  if (file->viewpoints.empty() && lies_flat(bounds.sizes() * frame.unit_m)) {
    const double turn = facings_of(*file).shows_back(1) ? -0.5 : 0.5;
    frame.T_scene_file.prerotate(Eigen::AngleAxisd(turn * std::numbers::pi, Eigen::Vector3d::UnitX()));
    frame.notes.emplace_back(
        "the thing lies flat on its back: stood up to face the visitor; if it should lie, make a "
        "scene package");
  }
  file->instances = instances;
  return frame;
}

}  // namespace cyclorama::scene
