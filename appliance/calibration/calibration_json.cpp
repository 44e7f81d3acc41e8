// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "appliance/calibration/calibration_file.h"
#include "common/json/strict_json.h"

namespace cyclorama::calibration {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr double kLarge = 1e9;
constexpr int kMaxPx = 16384;
constexpr int kMaxCells = 4096;
constexpr std::size_t kMaxNumbers = 8192;  // Maximum number of a wall's parameters.

template <typename Vector>
Json list_of(const Vector& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(value);
  return list;
}

Json json_of(const MeasuredLens& lens) {
  return {{"width_px", lens.width_px},
          {"height_px", lens.height_px},
          {"focal_px_centre_px_k1_k2_k3_p1_p2", list_of(lens.values)},
          {"covariance", rows_of(lens.covariance)}};
}

Json json_of(const SplineAxis& axis) {
  return {{"from_rad", axis.from}, {"step_rad", axis.step}, {"spans", axis.spans}};
}

Json json_of(const Surface& surface) {
  return {{"surface", name_of(surface.model)}, {"R_eye_wall", rows_of(surface.R_eye_wall)},
          {"distance_m", surface.distance_m},  {"across", json_of(surface.across)},
          {"up", json_of(surface.up)},         {"parameters", list_of(surface.parameters)}};
}

Json json_of(const CalibratedTurntable& turntable) {
  Json json{{"camera", json_of(turntable.camera)},
            {"pitch_rad", turntable.pitch_rad},
            {"roll_rad", turntable.roll_rad},
            {"offset_right_m", turntable.offset_m.x()},
            {"offset_forward_m", turntable.offset_m.y()},
            {"offset_right_sigma_m", turntable.offset_sigma_m.x()},
            {"offset_forward_sigma_m", turntable.offset_sigma_m.y()},
            {"is_offset_estimated", turntable.is_offset_estimated},
            {"offset_reason", turntable.offset_reason},
            {"inverse_depth_per_m", list_of(turntable.inverse_depth)},
            {"angles_rad", list_of(turntable.angles_rad)},
            {"reference", turntable.reference},
            {"parameters", turntable.parameters},
            {"covariance", rows_of(turntable.covariance)},
            {"rank", turntable.rank},
            {"tracks", turntable.tracks},
            {"rms_px", turntable.rms_px},
            {"heldout_rms_px", turntable.heldout_rms_px}};
  if (turntable.wall) json["wall"] = json_of(*turntable.wall);
  return json;
}

Json json_of(const std::vector<ModelTrial>& trials) {
  Json list = Json::array();
  for (const ModelTrial& t : trials) {
    list.push_back({{"name", t.name},
                    {"parameters", t.parameters},
                    {"training_rms_px", t.training_rms_px},
                    {"heldout_rms_px", t.heldout_rms_px},
                    {"scatter", t.scatter},
                    {"is_usable", t.is_usable}});
  }
  return list;
}

Json json_of(const ModelChoice& wall) {
  Json projectors = Json::array();
  for (const FittedProjector& p : wall.fit.projectors) {
    const Eigen::Quaterniond& q = p.T_eye_projector.rotation();
    const Eigen::Vector3d& t = p.T_eye_projector.translation();
    projectors.push_back({{"lens", json_of(p.lens)},
                          {"rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
                          {"position_m", {t.x(), t.y(), t.z()}},
                          {"pose_covariance", rows_of(p.pose_covariance)}});
  }
  Json json = json_of(wall.fit.surface);
  json.update(Json::object({{"lens", name_of(wall.lens)},
                            {"reason", wall.reason},
                            {"parameter_sigmas", list_of(wall.fit.surface_sigmas)},
                            {"cost", wall.fit.cost},
                            {"rank", wall.fit.rank},
                            {"fitted_parameters", wall.fit.parameters},
                            {"projectors", std::move(projectors)},
                            {"surface_trials", json_of(wall.surfaces)},
                            {"lens_trials", json_of(wall.lenses)}}));
  return json;
}

Eigen::MatrixXd matrix_of(StrictJson json, std::size_t size) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(size));
  Eigen::Index r = 0;
  for (const StrictJson& row : json.elements(size, size)) {
    Eigen::Index c = 0;
    for (const StrictJson& value : row.elements(size, size)) matrix(r, c++) = value.as_number(-1e18, 1e18);
    ++r;
  }
  return matrix;
}

MeasuredLens lens_of(StrictJson json) {
  MeasuredLens lens;
  lens.width_px = json.integer("width_px", 16, kMaxPx);
  lens.height_px = json.integer("height_px", 16, kMaxPx);
  const auto values =
      json.numbers("focal_px_centre_px_k1_k2_k3_p1_p2", MeasuredLens::kParameters, MeasuredLens::kParameters);
  std::copy(values.begin(), values.end(), lens.values.begin());
  lens.covariance = matrix_of(json.at("covariance"), MeasuredLens::kParameters);
  json.refuse_other_keys();
  return lens;
}

SplineAxis axis_of(StrictJson json) {
  SplineAxis axis;
  axis.from = json.number("from_rad", -7.0, 7.0);
  axis.step = json.number("step_rad", 1e-9, 7.0);
  axis.spans = json.integer("spans", 1, 64);
  json.refuse_other_keys();
  return axis;
}

/// Reads a surface whose keys are part of a larger object.
Surface surface_of(StrictJson* json) {
  Surface surface;
  const auto model = surface_model(json->text("surface", 60));
  if (!model) json->at("surface").refuse("is no surface; there are plane, cylinder, profile, quadric and mesh");
  surface.model = model.value_or(SurfaceModel::kPlane);
  surface.R_eye_wall = matrix_of(json->at("R_eye_wall"), 3);
  constexpr double kOrthogonal = 1e-6;
  if (!((surface.R_eye_wall.transpose() * surface.R_eye_wall - Eigen::Matrix3d::Identity()).norm() < kOrthogonal)) {
    json->at("R_eye_wall").refuse("is no rotation; calibrate again");
  }
  surface.distance_m = json->number("distance_m", 1e-3, 1e4);
  surface.across = axis_of(json->at("across"));
  surface.up = axis_of(json->at("up"));
  surface.parameters = json->numbers("parameters", 0, kMaxNumbers);
  if (static_cast<int>(surface.parameters.size()) != surface.size()) {
    json->at("parameters")
        .refuse(fmt::format("has {} numbers and needs {}; calibrate again", surface.parameters.size(), surface.size()));
  }
  return surface;
}

CalibratedTurntable turntable_of(StrictJson json) {
  constexpr std::size_t kMaxDirections = 4096;
  CalibratedTurntable turntable;
  turntable.camera = lens_of(json.at("camera"));
  turntable.pitch_rad = json.number("pitch_rad", -4.0, 4.0);
  turntable.roll_rad = json.number("roll_rad", -4.0, 4.0);
  turntable.offset_m.x() = json.number("offset_right_m", -10.0, 10.0);
  turntable.offset_m.y() = json.number("offset_forward_m", -10.0, 10.0);
  turntable.offset_sigma_m.x() = json.number("offset_right_sigma_m", 0.0, 10.0);
  turntable.offset_sigma_m.y() = json.number("offset_forward_sigma_m", 0.0, 10.0);
  turntable.is_offset_estimated = json.flag("is_offset_estimated");
  turntable.offset_reason = json.text("offset_reason");
  const auto inverse_depth = json.numbers("inverse_depth_per_m", kInverseDepthTerms, kInverseDepthTerms);
  std::copy(inverse_depth.begin(), inverse_depth.end(), turntable.inverse_depth.begin());
  turntable.angles_rad = json.numbers("angles_rad", 1, kMaxDirections);
  turntable.reference = static_cast<std::size_t>(json.integer("reference", 0, static_cast<int>(kMaxDirections)));
  if (turntable.reference >= turntable.angles_rad.size())
    json.at("reference").refuse("counts no direction; calibrate again");
  for (const StrictJson& name : json.list("parameters", 0, kMaxDirections))
    turntable.parameters.push_back(name.as_text(60));
  turntable.covariance = matrix_of(json.at("covariance"), turntable.parameters.size());
  turntable.rank = json.integer("rank", 0, kMaxPx);
  turntable.tracks = static_cast<std::size_t>(json.integer("tracks", 0, 1 << 30));
  turntable.rms_px = json.number("rms_px", 0.0, kLarge);
  turntable.heldout_rms_px = json.number("heldout_rms_px", 0.0, kLarge);
  if (json.has("wall")) {
    StrictJson wall = json.at("wall");
    turntable.wall = surface_of(&wall);
    wall.refuse_other_keys();
  }
  json.refuse_other_keys();
  return turntable;
}

std::vector<ModelTrial> trials_of(const std::vector<StrictJson>& list) {
  std::vector<ModelTrial> trials;
  for (StrictJson json : list) {
    ModelTrial t;
    t.name = json.text("name", 60);
    t.parameters = json.integer("parameters", 0, static_cast<int>(kMaxNumbers));
    t.training_rms_px = json.number("training_rms_px", 0.0, kLarge);
    t.heldout_rms_px = json.number("heldout_rms_px", 0.0, kLarge);
    t.scatter = json.number("scatter", 0.0, kLarge);
    t.is_usable = json.flag("is_usable");
    json.refuse_other_keys();
    trials.push_back(std::move(t));
  }
  return trials;
}

FittedProjector fitted_projector_of(StrictJson json) {
  FittedProjector p;
  p.lens = lens_of(json.at("lens"));
  const auto q = json.numbers("rotation_wxyz", 4, 4);
  const auto t = json.numbers("position_m", 3, 3);
  if (q.size() == 4 && t.size() == 3) {
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
    constexpr double kUnit = 1e-6;
    if (!(std::abs(rotation.norm() - 1.0) <= kUnit)) {
      json.at("rotation_wxyz").refuse("is no rotation: its length is not 1; calibrate again");
    } else {
      p.T_eye_projector = {rotation, {t[0], t[1], t[2]}};
    }
  }
  p.pose_covariance = matrix_of(json.at("pose_covariance"), 6);
  json.refuse_other_keys();
  return p;
}

ModelChoice wall_of(StrictJson json) {
  ModelChoice wall;
  wall.fit.surface = surface_of(&json);
  const auto lens = lens_model(json.text("lens", 60));
  if (!lens || freedom_of(*lens) > freedom_of(LensModel::kDecentred))
    json.at("lens").refuse("is no lens; there are pinhole, k1, 'k1 k2' and 'k1 k2 p1 p2'");
  wall.lens = lens.value_or(LensModel::kRadial1);
  wall.reason = json.text("reason");
  wall.fit.surface_sigmas = json.numbers("parameter_sigmas", 0, kMaxNumbers);
  wall.fit.cost = json.number("cost", 0.0, 1e18);
  wall.fit.rank = json.integer("rank", 0, static_cast<int>(kMaxNumbers));
  wall.fit.parameters = json.integer("fitted_parameters", 0, static_cast<int>(2 * kMaxNumbers));
  for (const StrictJson& p : json.list("projectors", 1, 64)) wall.fit.projectors.push_back(fitted_projector_of(p));
  wall.surfaces = trials_of(json.list("surface_trials", 0, 16));
  wall.lenses = trials_of(json.list("lens_trials", 0, 16));
  json.refuse_other_keys();
  return wall;
}

}  // namespace

std::string calibration_json(const Calibration& calibration) {
  Json projectors = Json::array();
  for (std::size_t i = 0; i < calibration.projectors.size(); ++i) {
    const CalibratedProjector& p = calibration.projectors[i];
    const std::string file = fmt::format("calibrations/{}/{}", calibration.date, i + 1);
    projectors.push_back({{"name", p.name},
                          {"width_px", p.map.width_px},
                          {"height_px", p.map.height_px},
                          {"cells_x", p.map.cells_x},
                          {"cells_y", p.map.cells_y},
                          {"map", file + ".map.pfm"},
                          {"sigma", file + ".sigma.pfm"},
                          {"heldout_rms_px", p.map.heldout_rms_px},
                          {"stiffness_px", p.map.stiffness_px},
                          {"samples", p.map.samples},
                          {"is_previous", p.is_previous}});
  }
  Json json{{"format", "cyclorama-calibration"},
            {"version", kVersion},
            {"date", calibration.date},
            {"turntable", json_of(calibration.turntable)},
            {"projectors", std::move(projectors)}};
  if (calibration.wall) json["wall"] = json_of(*calibration.wall);
  json["remarks"] = calibration.remarks;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<Calibration> parse_calibration(std::string_view text, const std::string& name) {
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, "go back to a calibration that was kept"));
  StrictJson::Mistakes mistakes("calibrate again");
  StrictJson json(document, &mistakes);
  Calibration calibration;
  if (json.text("format", 60) != "cyclorama-calibration")
    json.at("format").refuse("is not 'cyclorama-calibration'; give another file");
  json.require_version(kVersion);
  calibration.date = json.text("date", 40);
  if (calibration.date.empty() || calibration.date.find_first_not_of("0123456789TZ-") != std::string::npos) {
    json.at("date").refuse("is no date as 2026-11-22T13-05-00Z; calibrate again");
  }
  calibration.turntable = turntable_of(json.at("turntable"));
  std::set<std::string> names;
  std::size_t number = 0;
  for (StrictJson p : json.list("projectors", 1, 64)) {
    CalibratedProjector projector;
    projector.name = p.text("name", 200);
    if (!names.insert(projector.name).second) p.at("name").refuse("is another projector's name; give each its own");
    projector.map.width_px = p.integer("width_px", 16, kMaxPx);
    projector.map.height_px = p.integer("height_px", 16, kMaxPx);
    projector.map.cells_x = p.integer("cells_x", 1, kMaxCells);
    projector.map.cells_y = p.integer("cells_y", 1, kMaxCells);
    // The file cannot choose the paths of its maps, so that an untrusted file cannot make the program open other files.
    const std::string file = fmt::format("calibrations/{}/{}", calibration.date, ++number);
    if (p.text("map", 200) != file + ".map.pfm") p.at("map").refuse("is not '" + file + ".map.pfm'; calibrate again");
    if (p.text("sigma", 200) != file + ".sigma.pfm")
      p.at("sigma").refuse("is not '" + file + ".sigma.pfm'; calibrate again");
    projector.map.heldout_rms_px = p.number("heldout_rms_px", 0.0, kLarge);
    projector.map.stiffness_px = p.number("stiffness_px", 0.0, kLarge);
    projector.map.samples = static_cast<std::size_t>(p.integer("samples", 0, 1 << 30));
    projector.is_previous = p.flag("is_previous");
    p.refuse_other_keys();
    calibration.projectors.push_back(std::move(projector));
  }
  if (json.has("wall")) {
    calibration.wall = wall_of(json.at("wall"));
    if (calibration.wall->fit.projectors.size() != calibration.projectors.size()) {
      json.at("wall").refuse("has not as many projectors as the file; calibrate again");
    }
  }
  for (const StrictJson& remark : json.list("remarks", 0, 256)) calibration.remarks.push_back(remark.as_text());
  json.refuse_other_keys();
  TRY(mistakes.status(name));
  return calibration;
}

}  // namespace cyclorama::calibration
