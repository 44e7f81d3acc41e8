// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/tour_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "common/config/config.h"
#include "common/geometry/guard_band.h"

namespace cyclorama::tour {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTurnFollowedS = 0.2;
// Assumes ten frames a second, each shown from 0.2 s to 0.3 s after its request. Where frames are slower, the picture's
// edge becomes visible at full speed.
constexpr double kFrameIntervalS = 0.1;
constexpr double kFrameReplacedS = 0.3;
// Distance of the nearest surfaces, in the visitor's metres: the floor is no nearer, and few other things are.
constexpr double kNearM = 1.6;

const double kMaxGlideS = to_seconds(kMaxGlide);

double degrees(double radians) { return radians / kDegree; }
Duration seconds(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }

void read_gain(ConfigTable& walk, const std::string& name, const std::string& unit, double scale, double max,
               GainCurve* ret_curve) {
  const std::string dead = name + "_dead_" + unit;
  const std::string full = name + "_full_" + unit;
  ret_curve->dead = scale * walk.number(dead, {0.0, max}, ret_curve->dead / scale);
  ret_curve->full = scale * walk.number(full, {0.0, max}, ret_curve->full / scale);
  if (ret_curve->full <= ret_curve->dead) walk.refuse(full, fmt::format("must be above '{}'", dead));
}

void refuse_long_glide(ConfigTable& walk, const std::string& key, double speed, const RampLimits& limits) {
  const double seconds = max_stop_s(speed, limits);
  // The factor tolerates the rounding of degrees.
  if (speed == 0.0 || seconds <= kMaxGlideS * (1.0 + 1e-6)) return;
  walk.refuse(key, fmt::format("is too low: from full speed to rest takes up to {:.2f} s and may take {} s, so that a "
                               "lost tag stops the walk; raise it or the jerk, or lower the speed",
                               seconds, kMaxGlideS));
}

/// Speeds in metres per second. A farm rejects faster walks as not those of a visitor (renderfarm/trust/view_guard.h).
constexpr Range kSpeed{0.0, 2.0};

void read_walk(ConfigTable walk, NavigationSettings* ret_settings) {
  WalkLimits& limits = ret_settings->limits;
  limits.forward_m_per_s = walk.number("forward_m_per_s", kSpeed, limits.forward_m_per_s);
  limits.sideways_m_per_s = walk.number("sideways_m_per_s", kSpeed, limits.sideways_m_per_s);
  limits.turn_rad_per_s = kDegree * walk.number("turn_deg_per_s", {0.0, 180.0}, degrees(limits.turn_rad_per_s));
  limits.acceleration_m_per_s2 = walk.number("acceleration_m_per_s2", {0.01, 100.0}, limits.acceleration_m_per_s2);
  limits.jerk_m_per_s3 = walk.number("jerk_m_per_s3", {0.01, 10000.0}, limits.jerk_m_per_s3);
  limits.turn_acceleration_rad_per_s2 = kDegree * walk.number("turn_acceleration_deg_per_s2", {1.0, 1800.0},
                                                              degrees(limits.turn_acceleration_rad_per_s2));
  limits.turn_jerk_rad_per_s3 =
      kDegree * walk.number("turn_jerk_deg_per_s3", {1.0, 180000.0}, degrees(limits.turn_jerk_rad_per_s3));
  refuse_long_glide(walk, "acceleration_m_per_s2", std::max(limits.forward_m_per_s, limits.sideways_m_per_s),
                    {limits.acceleration_m_per_s2, limits.jerk_m_per_s3});
  refuse_long_glide(walk, "turn_acceleration_deg_per_s2", limits.turn_rad_per_s, limits.turning());

  TagSteeringSettings& tag = ret_settings->tag;
  tag.neutral_distance_m = walk.number("neutral_distance_m", {0.1, 20.0}, tag.neutral_distance_m);
  tag.neutral_right_m = walk.number("neutral_right_m", {-5.0, 5.0}, tag.neutral_right_m);
  read_gain(walk, "yaw", "deg", kDegree, 80.0, &tag.yaw_rad);
  read_gain(walk, "sideways", "m", 1.0, 5.0, &tag.sideways_m);
  read_gain(walk, "distance", "m", 1.0, 5.0, &tag.distance_m);
  BodySteeringSettings& body = ret_settings->body;
  walk.refuse_renamed("stand_m", "mark_distance_m");
  walk.refuse_renamed("stand_right_m", "mark_right_m");
  walk.refuse_renamed("longest_turn_minutes", "max_turn_minutes");
  body.mark_distance_m = walk.number("mark_distance_m", {0.5, 10.0}, body.mark_distance_m);
  body.neutral_right_m = walk.number("mark_right_m", {-5.0, 5.0}, body.neutral_right_m);
  read_gain(walk, "lean", "deg", kDegree, 60.0, &body.lean_rad);
  read_gain(walk, "step", "m", 1.0, 5.0, &body.sideways_m);
  read_gain(walk, "approach", "m", 1.0, 5.0, &body.distance_m);
  ret_settings->tag_smoothing =
      seconds(1e-3 * walk.number("tag_smoothing_ms", {0.0, 1000.0}, to_milliseconds(ret_settings->tag_smoothing)));
  ret_settings->guide_after =
      seconds(walk.number("guide_after_s", {0.0, 86400.0}, to_seconds(ret_settings->guide_after)));
  ret_settings->max_turn =
      seconds(60.0 * walk.number("max_turn_minutes", {0.0, 1440.0}, to_seconds(ret_settings->max_turn) / 60.0));
  ret_settings->turn_pause = seconds(walk.number("turn_pause_s", {0.0, 3600.0}, to_seconds(ret_settings->turn_pause)));
}

std::optional<TlsFiles> read_tls(ConfigTable& farm, const std::filesystem::path& folder) {
  if (!farm.has("authority") && !farm.has("certificate") && !farm.has("key")) return std::nullopt;
  return TlsFiles{folder / farm.text("authority"), folder / farm.text("certificate"), folder / farm.text("key")};
}

Result<TourSettings> read_from(Config config, const std::filesystem::path& folder) {
  TourSettings settings;
  ConfigTable root = config.root();
  // Tables that other programs read.
  for (const char* const others : {"display", "hours", "network", "update"}) static_cast<void>(root.has(others));
  ConfigTable farm = root.table("farm");
  farm.refuse_renamed("heads", "coordinators");
  settings.coordinators = farm.texts("coordinators", settings.coordinators);
  if (settings.coordinators.empty())
    farm.refuse("coordinators", "is empty; name the farm's coordinator, such as [\"[::1]:7401\"]");
  settings.scene = farm.text("scene", settings.scene);
  settings.museum = farm.text("museum", settings.museum);
  settings.tls = read_tls(farm, folder);
  read_walk(root.table("walk"), &settings.navigation);
  ConfigTable picture = root.table("picture");
  const bool is_fixed = picture.has("samples") || picture.has("jpeg_quality") || picture.has("subsample_chroma");
  settings.picture.frame_budget_ms = picture.number("frame_budget_ms", {0.0, is_fixed ? 0.0 : 60000.0},
                                                    is_fixed ? 0.0 : settings.picture.frame_budget_ms);
  settings.picture.reference_samples =
      picture.integer("reference_samples", {1, 4096}, settings.picture.reference_samples);
  settings.picture.samples = picture.integer("samples", {1, 4096}, settings.picture.samples);
  settings.picture.jpeg_quality = picture.integer("jpeg_quality", {1, 100}, settings.picture.jpeg_quality);
  settings.picture.subsample_chroma = picture.flag("subsample_chroma", settings.picture.subsample_chroma);
  settings.picture.guard_rad =
      kDegree * picture.number("guard_deg", {0.0, 90.0}, degrees(default_guard_rad(settings.navigation.limits)));
  ConfigTable tour = root.table("tour");
  if (const std::string name = tour.text("folder", ""); !name.empty()) settings.tour_folder = folder / name;
  constexpr double kMaxMib = 16.0 * 1024 * 1024;
  settings.keep_bytes =
      static_cast<std::uint64_t>(tour.integer("keep_mib", {0.0, kMaxMib}, static_cast<int>(kDefaultKeepBytes >> 20)))
      << 20;
  settings.fetch_after =
      seconds(60.0 * tour.number("fetch_after_min", {0.0, 1440.0}, to_seconds(settings.fetch_after) / 60.0));
  TRY(config.finish());
  return settings;
}

}  // namespace

double default_guard_rad(const WalkLimits& limits) { return kTurnFollowedS * limits.turn_rad_per_s; }

double walk_guard_rad(const WalkLimits& limits) {
  const double speed = std::max(limits.forward_m_per_s, limits.sideways_m_per_s);
  // A new command right after the request accelerates the walk, once the jerk limit allows it.
  const double acceleration = limits.acceleration_m_per_s2;
  const double accelerated_s = std::max(0.0, kFrameReplacedS - 0.5 * acceleration / limits.jerk_m_per_s3);
  const double missed_m = std::min(0.5 * acceleration * accelerated_s * accelerated_s, 2.0 * speed * accelerated_s);
  return parallax(std::max(0.5 * kFrameIntervalS * speed, missed_m), kNearM);
}

TourSettings default_tour_settings() {
  TourSettings settings;
  settings.picture.guard_rad = default_guard_rad(settings.navigation.limits);
  return settings;
}

Result<TourSettings> read_tour_settings(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return read_from(std::move(config), path.parent_path());
}

Result<TourSettings> parse_tour_settings(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  return read_from(std::move(config), {});
}

}  // namespace cyclorama::tour
