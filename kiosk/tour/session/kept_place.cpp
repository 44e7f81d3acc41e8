// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/kept_place.h"

#include <fmt/format.h>

#include "common/config/config.h"

namespace cyclorama {
namespace {

constexpr double kFarthestM = 1e6;

/// Returns the text as a TOML string. Names of scenes come from the network.
std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += fmt::format("\\{}", c);
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += fmt::format("\\u{:04X}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

}  // namespace

std::string to_text(const KeptPlace& place) {
  return fmt::format("scene = {}\nx_m = {}\nz_m = {}\nheading_rad = {}\n", toml_string(place.scene), place.place_m.x(),
                     place.place_m.y(), place.heading_rad);
}

Result<KeptPlace> parse_kept_place(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  ConfigTable root = config.root();
  KeptPlace place;
  place.scene = root.text("scene");
  place.place_m.x() = root.number("x_m", {-kFarthestM, kFarthestM});
  place.place_m.y() = root.number("z_m", {-kFarthestM, kFarthestM});
  place.heading_rad = root.number("heading_rad", {-kFarthestM, kFarthestM});
  TRY(config.finish());
  return place;
}

std::filesystem::path kept_place_path(const std::filesystem::path& folder) { return folder / "place.toml"; }

}  // namespace cyclorama
