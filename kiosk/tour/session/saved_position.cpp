// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/saved_position.h"

#include <fmt/format.h>

#include "common/config/config.h"
#include "common/config/toml_text.h"

namespace cyclorama::tour {
namespace {

constexpr double kMaxCoordinateM = 1e6;

}  // namespace

std::string to_text(const SavedPosition& position) {
  return fmt::format("scene = {}\nx_m = {}\nz_m = {}\nheading_rad = {}\n", toml_string(position.scene),
                     position.position_m.x(), position.position_m.y(), position.heading_rad);
}

Result<SavedPosition> parse_saved_position(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  ConfigTable root = config.root();
  SavedPosition position;
  position.scene = root.text("scene");
  position.position_m.x() = root.number("x_m", {-kMaxCoordinateM, kMaxCoordinateM});
  position.position_m.y() = root.number("z_m", {-kMaxCoordinateM, kMaxCoordinateM});
  position.heading_rad = root.number("heading_rad", {-kMaxCoordinateM, kMaxCoordinateM});
  TRY(config.finish());
  return position;
}

std::filesystem::path saved_position_path(const std::filesystem::path& folder) { return folder / "place.toml"; }

}  // namespace cyclorama::tour
