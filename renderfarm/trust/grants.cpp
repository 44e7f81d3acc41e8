// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/grants.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "common/config/config.h"

namespace cyclorama::trust {
namespace {

constexpr int kUsualSessions = 4;
/// Limits of a view on the wire (common/wire/view.proto).
constexpr int kMaxSamples = 4096;
constexpr int kMaxBounces = 64;
constexpr int kMaxPerDay = 1'000'000'000;
constexpr double kGibibyte = 1024.0 * 1024.0 * 1024.0;

/// Parses a watermark's key. Returns 0 if it is invalid.
std::uint64_t parse_watermark(std::string_view text) {
  std::uint64_t key = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, key, 16);
  return text.size() == 16 && error == std::errc() && stop == end ? key : 0;
}

Grant read_grant(ConfigTable& table) {
  Grant grant;
  grant.museum = table.text("name");
  grant.scenes = table.texts("scenes");
  grant.weight = table.number("weight", {0.01, 100.0}, 1.0);
  table.refuse_renamed("visits", "sessions");
  grant.sessions = table.integer("sessions", {1, 1024}, kUsualSessions);
  if (table.has("megabytes_per_s")) grant.bytes_per_second = 1e6 * table.number("megabytes_per_s", {0.1, 1e5});
  if (table.has("cores")) grant.cores = table.number("cores", {0.1, 1e6});
  if (table.has("megapixels_per_s")) grant.megapixels_per_second = table.number("megapixels_per_s", {0.01, 1e6});
  grant.samples = table.integer("samples", {1, kMaxSamples}, kMaxSamples);
  grant.bounces = table.integer("bounces", {0, kMaxBounces}, kMaxBounces);
  if (table.has("scene_gib")) grant.scene_bytes = kGibibyte * table.number("scene_gib", {0.1, 1e5});
  grant.free_eye = table.flag("free_eye", false);
  if (table.has("views_per_day")) grant.views_per_day = table.integer("views_per_day", {1, kMaxPerDay}, 0);
  if (table.has("places_per_day")) grant.places_per_day = table.integer("places_per_day", {1, kMaxPerDay}, 0);
  if (table.has("watermark")) {
    grant.watermark = parse_watermark(table.text("watermark"));
    if (grant.watermark == 0) table.refuse("watermark", "is no key; write 16 hexadecimal digits, not all 0");
  }
  grant.updates = table.flag("updates", true);
  if (grant.museum.empty()) table.refuse("name", "is empty; write the name in the museum's certificate");
  if (grant.scenes.empty()) table.refuse("scenes", "is empty; write [\"*\"] for all, or leave the museum out");
  if (grant.scenes.size() > 1 && std::ranges::count(grant.scenes, "*") > 0) {
    table.refuse("scenes", "has \"*\" among others; write it alone");
  }
  return grant;
}

}  // namespace

bool Grant::allows(std::string_view scene) const {
  return std::ranges::any_of(scenes, [&](const std::string& granted) { return granted == "*" || granted == scene; });
}

Result<Grants> Grants::parse(std::string_view text, const std::string& name) {
  TRY_ASSIGN(Config config, Config::parse(text, name));
  Grants grants;
  ConfigTable root = config.root();
  for (ConfigTable& table : root.tables("museum")) {
    Grant grant = read_grant(table);
    const std::string museum = grant.museum;
    if (!grants.grants_.emplace(museum, std::move(grant)).second) table.refuse("name", "is given twice");
  }
  TRY(config.finish());
  return grants;
}

const Grant* Grants::find(std::string_view museum) const {
  const auto found = grants_.find(museum);
  return found == grants_.end() ? nullptr : &found->second;
}

}  // namespace cyclorama::trust
