// SPDX-License-Identifier: Apache-2.0
#include "common/room/installation.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "common/base/file.h"
#include "common/config/config.h"
#include "common/room/file_beside.h"
#include "common/room/read_wall.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Range kMetres{-100.0, 100.0};
constexpr Range kAngles{-360.0, 360.0};

Point<frame::Room> point_of(const std::vector<double>& xyz) { return {Eigen::Vector3d(xyz[0], xyz[1], xyz[2])}; }

/// Returns a pan to the right, then a tilt upwards, then a roll clockwise as seen from behind; at zero the lens looks
/// along -z.
Eigen::Quaterniond aimed(double pan_rad, double tilt_rad, double roll_rad) {
  const Eigen::Quaterniond looking_ahead(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  return Eigen::AngleAxisd(-pan_rad, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()) *
         looking_ahead * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ());
}

/// Returns the error text for a projector or eye at an impossible position.
const char* wrong_side(const Wall& wall) {
  if (std::holds_alternative<CylinderWall>(wall)) return "is outside the wall; it must be inside its radius";
  if (std::holds_alternative<DomeWall>(wall)) return "is outside the dome; it must be inside its radius";
  if (std::holds_alternative<MeshWall>(wall)) {
    return "is behind the wall; move it, or turn the mesh's faces: they run counter-clockwise as the visitor sees them";
  }
  return "is behind the wall; move it, or turn the wall: corners_m go from the visitor's left to right";
}

Plug read_plug(ConfigTable* table, const std::filesystem::path& folder) {
  Plug plug;
  plug.connector = table->text("connector", "");
  if (table->has("card")) plug.card = table->integer("card", {0, 15});
  if (plug.card && plug.connector.empty()) table->refuse("card", "has no effect without a 'connector'");
  if (plug.connector.find(':') != std::string::npos)
    table->refuse("connector", "is a connector's name, such as HDMI-A-1; write card = 1 for one on the second card");
  plug.serial = table->text("serial", "");
  if (!plug.serial.empty() && !plug.connector.empty())
    table->refuse("serial", "and 'connector' both name the head; leave one out: a serial follows the projector");
  if (table->has("edid")) plug.edid = file_beside(table, "edid", folder);
  plug.is_always_connected = table->choice("connect", {"detected", "always"}, "detected") == "always";
  if (plug.is_always_connected && (plug.connector.empty() || plug.edid.empty()))
    table->refuse("connect",
                  "= \"always\" needs 'connector', the head to drive, and 'edid', the file with its timings");
  if (!plug.edid.empty() && !plug.serial.empty())
    table->refuse("edid", "replaces what the projector reports, so that 'serial' cannot find it; write its connector");
  plug.turn_deg = table->integer("turn_deg", {0, 270}, 0);
  if (plug.turn_deg % 90 != 0) table->refuse("turn_deg", "must be 0, 90, 180 or 270");
  return plug;
}

std::optional<PjlinkPlace> read_pjlink(ConfigTable* table, const std::filesystem::path& folder) {
  const std::string password_file = table->text("pjlink_password_file", "");
  const std::string text = table->text("pjlink", "");
  if (text.empty()) {
    if (!password_file.empty()) table->refuse("pjlink_password_file", "needs 'pjlink', the projector's address");
    return std::nullopt;
  }
  const auto address = parse_projector_address(text);
  if (!address) {
    table->refuse("pjlink", "must be HOST or HOST:PORT, such as 192.0.2.11 or [2001:db8::11]:4352");
    return std::nullopt;
  }
  return PjlinkPlace{*address, password_file.empty() ? std::filesystem::path() : folder / password_file};
}

void refuse_shared_connectors(const std::vector<InstalledProjector>& projectors, ConfigTable* table) {
  const Plug& added = projectors.back().plug;
  for (std::size_t i = 0; i + 1 < projectors.size(); ++i) {
    const Plug& other = projectors[i].plug;
    if (!added.connector.empty() && added.connector == other.connector && added.card == other.card)
      table->refuse("connector", fmt::format("is the connector of '{}' too; each has its own", projectors[i].name));
    if (!added.serial.empty() && added.serial == other.serial)
      table->refuse("serial",
                    fmt::format("is the serial of '{}' too; write their connectors instead", projectors[i].name));
  }
}

std::optional<InstalledStereo> read_stereo(ConfigTable* root) {
  if (!root->has("stereo")) return std::nullopt;
  ConfigTable table = root->table("stereo");
  InstalledStereo stereo;
  const std::string packing = table.choice("packing", {"side-by-side", "top-bottom", "frame-sequential"});
  if (packing == "top-bottom") stereo.packing = StereoPacking::kTopBottom;
  if (packing == "frame-sequential") stereo.packing = StereoPacking::kFrameSequential;
  stereo.eye_distance_m = table.number("eye_distance_m", {0.001, 1.0}, stereo.eye_distance_m);
  return stereo;
}

/// Refuses an odd length of the side that is divided between two eyes.
void refuse_odd_sides(const std::optional<InstalledStereo>& stereo, const Pinhole& lens, ConfigTable* projector) {
  if (!stereo) return;
  const char* const what = "must be even: with this [stereo] packing two eyes share it";
  if (stereo->packing == StereoPacking::kSideBySide && lens.width_px % 2 != 0) projector->refuse("width_px", what);
  if (stereo->packing == StereoPacking::kTopBottom && lens.height_px % 2 != 0) projector->refuse("height_px", what);
}

std::optional<InstalledWarp> read_warp(ConfigTable* table, const std::filesystem::path& folder) {
  if (!table->has("warp")) return std::nullopt;
  InstalledWarp warp;
  warp.file = file_beside(table, "warp", folder);
  warp.region = table->text("warp_region", "");
  if (table->has("warp_mask")) warp.mask = file_beside(table, "warp_mask", folder);
  return warp;
}

InstalledProjector read_projector(ConfigTable table, const std::optional<Wall>& wall,
                                  const std::filesystem::path& folder) {
  InstalledProjector projector;
  projector.name = table.text("name");
  const int width = table.integer("width_px", {16, 8192});
  const int height = table.integer("height_px", {16, 8192});
  projector.lens =
      Pinhole::from_field_of_view(width, height, table.number("field_of_view_deg", {1.0, 150.0}) * kDegree);
  const std::vector<double> shift = table.numbers("lens_shift_fraction", 2, {-1.0, 1.0}, std::vector<double>{0.0, 0.0});
  projector.lens.centre_u_px += shift[0] * width;
  projector.lens.centre_v_px += shift[1] * height;
  const Point<frame::Room> position = point_of(table.numbers("position_m", 3, kMetres));
  const double pan = table.number("pan_deg", kAngles, 0.0) * kDegree;
  const double tilt = table.number("tilt_deg", kAngles, 0.0) * kDegree;
  const double roll = table.number("roll_deg", kAngles, 0.0) * kDegree;
  projector.T_room_projector = {aimed(pan, tilt, roll), position.xyz};
  projector.plug = read_plug(&table, folder);
  projector.pjlink = read_pjlink(&table, folder);
  if (wall && !is_lit_from(*wall, position)) table.refuse("position_m", wrong_side(*wall));
  projector.warp = read_warp(&table, folder);
  return projector;
}

}  // namespace

Status check_connectors(const Installation& installation) {
  if (installation.projectors.size() < 2) return Done{};
  for (const InstalledProjector& projector : installation.projectors) {
    if (!projector.plug.connector.empty() || !projector.plug.serial.empty()) continue;
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("projector '{}' has neither 'connector' nor 'serial', so after a power cut it could show "
                             "another one's picture: write the connector that it is plugged into, such as connector = "
                             "\"HDMI-A-1\", or the serial of its EDID",
                             projector.name));
  }
  return Done{};
}

Result<Address> parse_projector_address(const std::string& text) {
  constexpr int kPjlinkPort = 4352;
  auto address = parse_address(text);
  return address ? address : parse_address(fmt::format("{}:{}", text, kPjlinkPort));
}

Result<Installation> parse_installation(std::string_view text, std::string name, const std::filesystem::path& folder) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  ConfigTable root = config.root();
  Installation installation;
  installation.name = root.text("name");

  for (const std::string& card : root.texts("cards", std::vector<std::string>{})) installation.cards.emplace_back(card);

  const std::optional<Wall> wall = read_wall(root.table("wall"), folder);
  if (wall) installation.wall = *wall;

  ConfigTable visitor = root.table("visitor");
  installation.sweet_spot = point_of(visitor.numbers("eye_m", 3, kMetres));
  if (wall && !is_lit_from(*wall, installation.sweet_spot)) visitor.refuse("eye_m", wrong_side(*wall));

  installation.stereo = read_stereo(&root);
  for (ConfigTable& table : root.tables("projector")) {
    installation.projectors.push_back(read_projector(table, wall, folder));
    refuse_odd_sides(installation.stereo, installation.projectors.back().lens, &table);
    refuse_shared_connectors(installation.projectors, &table);
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
  return parse_installation(text, path.string(), path.parent_path());
}

}  // namespace cyclorama
