// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tracker_settings.h"

#include <numbers>

#include "appliance/calibration/camera_file.h"
#include "common/base/check.h"
#include "common/config/config.h"
#include "common/wand/folded_card.h"
#include "drivers/camera/camera_settings.h"

namespace cyclorama::tracker {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Status read_camera_table(ConfigTable camera, const std::filesystem::path& folder, TrackerSettings* ret) {
  ret->camera = camera::camera_source(&camera, ret->camera);
  ret->name = camera.text("name", ret->name);
  ret->lens.field_of_view_rad = camera.number("field_of_view_deg", {1, 170}, 60.0) * kDegree;
  if (camera.has("focal_px")) {
    ret->lens.focal_px = camera.number("focal_px", {1, 1e6});
    if (camera.has("field_of_view_deg")) camera.refuse("field_of_view_deg", "and focal_px say the same; remove one");
  }
  if (camera.has("centre_px")) {
    const std::vector<double> centre = camera.numbers("centre_px", 2, {-1e6, 1e6});
    if (centre.size() == 2) ret->lens.centre_px = Eigen::Vector2d(centre[0], centre[1]);
  }
  if (!camera.has("lens")) return Done{};
  for (const char* key : {"field_of_view_deg", "focal_px", "centre_px"}) {
    if (camera.has(key)) camera.refuse(key, "and lens say the same; remove one");
  }
  TRY_ASSIGN(const calibration::CameraFile file, calibration::read_camera(folder / camera.text("lens", "")));
  ret->lens.calibrated = file.lens;
  return Done{};
}

/// Reads [tag] (flat tags) and [wand] (standard or measured wands).
Status read_patterns(ConfigTable root, const std::filesystem::path& folder, TrackerSettings* ret) {
  const bool has_tag = root.has("tag");
  ConfigTable tag = root.table("tag");
  ret->detector.family = tag.choice("family", tags::tag_families(), ret->detector.family);
  PatternSettings& patterns = ret->tracking.patterns;
  if (has_tag) {
    patterns.flat_tag_size_m = 1e-3 * tag.number("size_mm", {1, 10000}, 120.0);
    if (tag.has("id")) patterns.only = tag.integer("id", {0, 1e6});
  }
  const bool has_wand = root.has("wand");
  ConfigTable wand = root.table("wand");
  const std::vector<std::string> files = wand.texts("files", std::vector<std::string>{});
  if (wand.has("number")) patterns.only = wand.integer("number", {0, kStandardWands - 1});
  if (has_tag && has_wand) root.refuse("wand", "and [tag] say what visitors hold; remove one");
  if (!files.empty() && wand.has("number")) wand.refuse("number", "is of the standard wands, and files replace them");
  for (const std::string& file : files) {
    TRY_ASSIGN(Wand one, read_wand(folder / file));
    patterns.wands.push_back(std::move(one));
  }
  return Done{};
}

void read_detector(ConfigTable detector, tags::DetectorSettings* ret) {
  ret->decimate = detector.number("decimate", {1, 8}, ret->decimate);
  ret->tiles = detector.flag("tiles", ret->tiles);
  ret->threads = detector.integer("threads", {1, 16}, ret->threads);
  ret->refine_edges = detector.flag("refine_edges", ret->refine_edges);
  ret->refine_corners = detector.flag("refine_corners", ret->refine_corners);
  detector.refuse_renamed("most_hamming", "max_hamming");
  detector.refuse_renamed("least_margin_grey", "min_margin_grey");
  ret->max_hamming = detector.integer("max_hamming", {0, 2}, ret->max_hamming);
  ret->min_margin = detector.number("min_margin_grey", {0, 255}, ret->min_margin);
}

void read_filter(ConfigTable filter, TrackingSettings* ret) {
  constexpr Range kCutoff{0.01, 1000};
  constexpr Range kPerSpeed{0, 1000};
  OneEuroSettings& position = ret->position;
  position.min_cutoff_hz = filter.number("position_cutoff_hz", kCutoff, position.min_cutoff_hz);
  position.cutoff_per_speed = filter.number("position_cutoff_hz_per_m_s", kPerSpeed, position.cutoff_per_speed);
  OneEuroSettings& rotation = ret->rotation;
  rotation.min_cutoff_hz = filter.number("rotation_cutoff_hz", kCutoff, rotation.min_cutoff_hz);
  rotation.cutoff_per_speed = filter.number("rotation_cutoff_hz_per_rad_s", kPerSpeed, rotation.cutoff_per_speed);
  ret->corner_floor_px = filter.number("corner_floor_px", {0.001, 10}, ret->corner_floor_px);
  ret->chooser.memory_s = filter.number("memory_s", {0.01, 60}, ret->chooser.memory_s);
}

void read_body(ConfigTable body, TrackerSettings* ret) {
  BodySettings& settings = ret->body;
  body.refuse_renamed("stand_m", "mark_distance_m");
  body.refuse_renamed("reach_m", "follow_radius_m");
  settings.mark_distance_m = body.number("mark_distance_m", {0.5, 10.0}, settings.mark_distance_m);
  settings.follow_radius_m = body.number("follow_radius_m", {0.2, 5.0}, settings.follow_radius_m);
  settings.begin_within_m = body.number("begin_within_m", {0.1, 5.0}, settings.begin_within_m);
  ret->background.cells_across = body.integer("cells_across", {40, 1280}, ret->background.cells_across);
}

Result<TrackerSettings> from_config(Config* config, const std::filesystem::path& folder) {
  TrackerSettings settings;
  ConfigTable root = config->root();
  const Status camera = read_camera_table(root.table("camera"), folder, &settings);
  const Status patterns = read_patterns(root, folder, &settings);
  read_detector(root.table("detector"), &settings.detector);
  read_filter(root.table("filter"), &settings.tracking);
  read_body(root.table("body"), &settings);
  if (root.choice("steer_by", {"wand", "body"}, "wand") == "body") settings.steer_by = SteerBy::kBody;
  settings.tour = root.text("tour", settings.tour);
  settings.listen = root.text("listen", settings.listen);
  settings.osc = root.text("osc", settings.osc);
  settings.vrpn = root.text("vrpn", settings.vrpn);
  TRY(config->finish());
  TRY(camera);
  TRY(patterns);
  return settings;
}

}  // namespace

Result<TrackerSettings> TrackerSettings::read(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return from_config(&config, path.parent_path());
}

Result<TrackerSettings> TrackerSettings::parse(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  return from_config(&config, {});
}

Pinhole lens_for(const LensSettings& settings, int width_px, int height_px) {
  CHECK(width_px > 0 && height_px > 0);
  if (settings.calibrated) {
    const auto lens = calibration::lens_for_picture(*settings.calibrated, width_px, height_px);
    using L = calibration::MeasuredLens;
    if (lens) {
      return {width_px, height_px, lens->values[L::kFocal], lens->values[L::kCentreU], lens->values[L::kCentreV], 1.0};
    }
  }
  Pinhole lens = Pinhole::from_field_of_view(width_px, height_px, settings.field_of_view_rad);
  if (settings.focal_px) lens.focal_px = *settings.focal_px;
  if (settings.centre_px) {
    lens.centre_u_px = settings.centre_px->x();
    lens.centre_v_px = settings.centre_px->y();
  }
  return lens;
}

}  // namespace cyclorama::tracker
