// SPDX-License-Identifier: Apache-2.0
#include "kiosk/setup/room_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/config/toml_text.h"
#include "common/room/installation.h"

namespace cyclorama::setup {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kColumns = 120;
constexpr int kRows = 40;
constexpr int kOutlinePoints = 16;  // Points on one side of a picture.
constexpr double kEnoughLit = 0.995;
constexpr double kEnoughShared = 0.02;

double length_of(const RoomPlan& plan) { return plan.is_round ? plan.radius_m * plan.arc_deg * kDegree : plan.width_m; }

/// Returns the point of the wall in the room.
Eigen::Vector3d in_room(const RoomPlan& plan, const WallPoint& point) {
  const double from_middle = point.along_m - length_of(plan) / 2.0;
  if (!plan.is_round) return {from_middle, point.height_m, -plan.distance_m};
  const double angle = from_middle / plan.radius_m;
  return {plan.radius_m * std::sin(angle), point.height_m, -plan.radius_m * std::cos(angle)};
}

WallPoint on_wall(const RoomPlan& plan, const Eigen::Vector3d& point) {
  const double from_middle = plan.is_round ? plan.radius_m * std::atan2(point.x(), -point.z()) : point.x();
  return {from_middle + length_of(plan) / 2.0, point.y()};
}

std::string projector_toml(const RoomPlan& plan, std::size_t index) {
  const PlannedProjector& projector = plan.projectors[index];
  const double along =
      length_of(plan) * (static_cast<double>(index) + 0.5) / static_cast<double>(plan.projectors.size());
  const Eigen::Vector3d target = in_room(plan, {along, plan.lens_height_m});
  const Eigen::Vector3d towards =
      plan.is_round ? Eigen::Vector3d(target.x(), 0.0, target.z()).normalized() : Eigen::Vector3d(0.0, 0.0, -1.0);
  const Eigen::Vector3d lens = target - plan.lens_distance_m * towards;
  const bool is_upright = projector.turn_deg % 180 == 90;
  const int width_px = is_upright ? projector.height_px : projector.width_px;
  const int height_px = is_upright ? projector.width_px : projector.height_px;
  const double field_deg = 2.0 * std::atan(plan.picture_width_m / (2.0 * plan.lens_distance_m)) / kDegree;
  const double picture_height_m = plan.picture_width_m * height_px / width_px;
  // The picture's middle is shifted from the lens's height to that of the wall's middle.
  const double shift =
      std::clamp(((plan.bottom_m + plan.top_m) / 2.0 - plan.lens_height_m) / picture_height_m, -1.0, 1.0);
  std::string text = fmt::format("\n[[projector]]\nname = {}\nconnector = {}\n", toml_string(projector.name),
                                 toml_string(projector.connector));
  if (projector.turn_deg != 0) text += fmt::format("turn_deg = {}\n", projector.turn_deg);
  text += fmt::format(
      "width_px = {}\nheight_px = {}\nfield_of_view_deg = {:.3f}\nlens_shift_fraction = [0.0, {:.4f}]\n"
      "position_m = [{:.4f}, {:.4f}, {:.4f}]\npan_deg = {:.3f}\n",
      width_px, height_px, field_deg, shift, lens.x(), plan.lens_height_m, lens.z(),
      std::atan2(towards.x(), -towards.z()) / kDegree);
  if (!projector.pjlink.empty()) text += fmt::format("pjlink = {}\n", toml_string(projector.pjlink));
  return text;
}

/// Returns whether the projector lights the point; its own frame has no other parts in the way.
bool is_lit(const InstalledProjector& projector, const Eigen::Vector3d& point) {
  const auto seen = projector.T_room_projector.inverse() * Point<frame::Room>{point};
  const auto pixel = projector.lens.pixel_of(seen.xyz);
  return pixel && projector.lens.contains(*pixel);
}

std::vector<WallPoint> picture_on(const RoomPlan& plan, const Installation& room, const InstalledProjector& projector) {
  std::vector<WallPoint> points;
  const double width = projector.lens.width_px;
  const double height = projector.lens.height_px;
  const auto add = [&](double u, double v) {
    const Eigen::Vector3d direction = projector.T_room_projector.rotation() * projector.lens.direction_at(u, v);
    const RoomRay ray{Point<frame::Room>{projector.T_room_projector.translation()}, direction};
    if (const auto point = hit_extended(room.wall, ray)) points.push_back(on_wall(plan, point->xyz));
  };
  for (int i = 0; i < kOutlinePoints; ++i) add(width * i / kOutlinePoints, 0.0);
  for (int i = 0; i < kOutlinePoints; ++i) add(width, height * i / kOutlinePoints);
  for (int i = kOutlinePoints; i > 0; --i) add(width * i / kOutlinePoints, height);
  for (int i = kOutlinePoints; i > 0; --i) add(0.0, height * i / kOutlinePoints);
  return points;
}

/// Counts the unlit points of the wall by their place, for the hints.
struct Unlit {
  int left = 0, right = 0, above = 0, below = 0, between = 0;
};

std::vector<std::string> hints_for(const Unlit& unlit, const Reach& reach, std::size_t projectors) {
  std::vector<std::string> hints;
  if (unlit.above > 0)
    hints.emplace_back("The top of the wall stays dark: hang the projectors higher, or make their pictures larger.");
  if (unlit.below > 0)
    hints.emplace_back("The bottom of the wall stays dark: shift the lenses down, or make the pictures larger.");
  if (unlit.left > 0 || unlit.right > 0)
    hints.emplace_back("The sides of the wall stay dark: make the pictures larger, or use one projector more.");
  if (unlit.between > 0)
    hints.emplace_back("There is a gap between two pictures: make them larger, or use one projector more.");
  if (projectors > 1 && hints.empty() && reach.shared_fraction < kEnoughShared)
    hints.emplace_back("Neighbouring pictures hardly overlap: make them larger, so that their seams can be blended.");
  return hints;
}

}  // namespace

std::string installation_toml(const RoomPlan& plan) {
  std::string text = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n# Made on the operator page from measured lengths; a calibration "
      "measures "
      "the rest.\nname = {}\n\n[wall]\n",
      toml_string(plan.name));
  if (plan.is_round) {
    text +=
        fmt::format("shape = \"cylinder\"\nradius_m = {:.4f}\narc_deg = {:.4f}\nbottom_m = {:.4f}\ntop_m = {:.4f}\n",
                    plan.radius_m, plan.arc_deg, plan.bottom_m, plan.top_m);
  } else {
    text += fmt::format("shape = \"plane\"\ncentre_m = [0.0, {:.4f}, {:.4f}]\nwidth_m = {:.4f}\nheight_m = {:.4f}\n",
                        (plan.bottom_m + plan.top_m) / 2.0, -plan.distance_m, plan.width_m, plan.top_m - plan.bottom_m);
  }
  text += fmt::format("\n[visitor]\neye_m = [0.0, {:.4f}, 0.0]\n", plan.eye_m);
  for (std::size_t i = 0; i < plan.projectors.size(); ++i) text += projector_toml(plan, i);
  return text;
}

Result<Reach> reach_of(const RoomPlan& plan) {
  TRY_ASSIGN(const Installation room, parse_installation(installation_toml(plan), "installation.toml"));
  Reach reach;
  reach.length_m = length_of(plan);
  for (const InstalledProjector& projector : room.projectors)
    reach.pictures.push_back(picture_on(plan, room, projector));
  Unlit unlit;
  int lit = 0;
  int shared = 0;
  for (int row = 0; row < kRows; ++row) {
    const double height = plan.bottom_m + (plan.top_m - plan.bottom_m) * (row + 0.5) / kRows;
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector3d point = in_room(plan, {reach.length_m * (column + 0.5) / kColumns, height});
      const auto lights =
          std::ranges::count_if(room.projectors, [&](const auto& projector) { return is_lit(projector, point); });
      lit += lights > 0 ? 1 : 0;
      shared += lights > 1 ? 1 : 0;
      if (lights > 0) continue;
      if (row == kRows - 1)
        ++unlit.above;
      else if (row == 0)
        ++unlit.below;
      else if (column == 0)
        ++unlit.left;
      else if (column == kColumns - 1)
        ++unlit.right;
      else
        ++unlit.between;
    }
  }
  reach.lit_fraction = static_cast<double>(lit) / (kRows * kColumns);
  reach.shared_fraction = static_cast<double>(shared) / (kRows * kColumns);
  // A gap that reaches an edge is reported once, by that edge.
  if (unlit.above + unlit.below + unlit.left + unlit.right > 0) unlit.between = 0;
  reach.hints = hints_for(reach.lit_fraction < kEnoughLit ? unlit : Unlit{}, reach, room.projectors.size());
  return reach;
}

}  // namespace cyclorama::setup
