// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/show_file.h"

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "common/json/strict_json.h"

namespace cyclorama::calibration {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr int kMaxPx = 16384;
constexpr double kMaxDistanceM = 1e3;
// Minimum determinant; six standard deviations of a micrometre or microradian would give 1e-36.
constexpr double kFlattest = 1e-60;
constexpr std::size_t kMaxDevices = 64;
constexpr float kLightSteps = 65535.0f;
constexpr std::size_t kMaxBytes = std::size_t{1} << 20;

Json json_of(const BrownParameters& lens) {
  Json values = Json::array();
  for (const double value : to_block(lens)) values.push_back(value);
  return {{"width_px", lens.width_px},
          {"height_px", lens.height_px},
          {"focal_u_px_focal_v_px_centre_u_px_centre_v_px_k1_k2_p1_p2_k3", std::move(values)}};
}

template <typename Body>
Json json_of(const RigidTransform<frame::Room, Body>& T) {
  const Eigen::Quaterniond& q = T.rotation();
  const Eigen::Vector3d& t = T.translation();
  return {{"rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}}, {"position_m", {t.x(), t.y(), t.z()}}};
}

Json json_of(const PoseMatrix& root) {
  Json values = Json::array();
  for (const double value : root.reshaped()) values.push_back(value);
  return values;
}

BrownParameters lens_of(StrictJson json) {
  const int width = json.integer("width_px", 1, kMaxPx);
  const int height = json.integer("height_px", 1, kMaxPx);
  const auto values =
      json.numbers("focal_u_px_focal_v_px_centre_u_px_centre_v_px_k1_k2_p1_p2_k3", kBrownValues, kBrownValues);
  json.refuse_other_keys();
  BrownBlock block{1.0, 1.0};
  if (values.size() == block.size()) std::copy(values.begin(), values.end(), block.begin());
  if (!(block[kFocalU] > 0.0 && block[kFocalV] > 0.0)) json.refuse("has no focal length; place the cameras again");
  return from_block(block, width, height);
}

template <typename Body>
RigidTransform<frame::Room, Body> pose_of(StrictJson json) {
  std::vector<double> q;
  for (const StrictJson& value : json.list("rotation_wxyz", 4, 4))
    q.push_back(value.as_number(-1.0 - 1e-9, 1.0 + 1e-9));
  std::vector<double> t;
  for (const StrictJson& value : json.list("position_m", 3, 3))
    t.push_back(value.as_number(-kMaxDistanceM, kMaxDistanceM));
  json.refuse_other_keys();
  if (q.size() != 4 || t.size() != 3) return {};
  const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
  if (!(std::abs(turn.norm() - 1.0) < 1e-6)) {
    json.refuse("is no rotation; place the cameras again");
    return {};
  }
  return {turn, {t[0], t[1], t[2]}};
}

Json json_of(const std::array<CodeLight, 3>& light) {
  Json values = Json::array();
  for (const CodeLight& channel : light) {
    for (const float part : channel) values.push_back(static_cast<int>(std::lround(kLightSteps * part)));
  }
  return values;
}

/// Reads the light channel by channel.
std::array<CodeLight, 3> light_of(StrictJson* json) {
  std::array<CodeLight, 3> light{};
  const std::size_t codes = light[0].size();
  const std::vector<StrictJson> values = json->list("light_65535", 3 * codes, 3 * codes);
  for (std::size_t i = 0; i < values.size(); ++i)
    light[i / codes][i % codes] = static_cast<float>(values[i].as_number(0.0, kLightSteps, true)) / kLightSteps;
  return light;
}

/// Reads a matrix in column-major order.
PoseMatrix root_of(StrictJson* json) {
  PoseMatrix root = PoseMatrix::Identity();
  const std::vector<StrictJson> values = json->list("root", 36, 36);
  if (values.size() != 36) return root;
  for (Eigen::Index i = 0; i < 36; ++i) root.reshaped()[i] = values[static_cast<std::size_t>(i)].as_number(-1.0, 1.0);
  if (!(std::abs(root.determinant()) > kFlattest))
    json->refuse("is more certain than is possible; place the cameras again");
  return root;
}

}  // namespace

std::string show_json(const ShowFile& show) {
  Json projectors = Json::array();
  for (const ShowFile::Projector& p : show.projectors) {
    Json one{
        {"name", p.name}, {"lens", json_of(p.lens)}, {"scanned", json_of(p.scanned)}, {"applied", json_of(p.applied)}};
    if (p.learned) {
      one["learned"] = {{"believed", json_of(p.learned->believed)},
                        {"at_rest", json_of(p.learned->at_rest)},
                        {"root", json_of(p.learned->root)}};
    }
    if (!p.unplaced.empty()) one["unplaced"] = p.unplaced;
    if (p.light) one["light_65535"] = json_of(*p.light);
    projectors.push_back(std::move(one));
  }
  Json cameras = Json::array();
  for (const ShowFile::Camera& c : show.cameras) {
    Json one{{"name", c.name}, {"lens", json_of(c.lens)}, {"pose", json_of(c.T_room_camera)}};
    if (c.root) one["root"] = json_of(*c.root);
    cameras.push_back(std::move(one));
  }
  const Json json{{"version", kVersion},
                  {"calibration", show.calibration},
                  {"projectors", std::move(projectors)},
                  {"cameras", std::move(cameras)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<ShowFile> parse_show(std::string_view text, const std::string& name) {
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, "calibrate again"));
  StrictJson::Mistakes mistakes("calibrate again");
  StrictJson json(document, &mistakes);
  ShowFile show;
  json.require_version(kVersion);
  show.calibration = json.text("calibration", 100);
  for (StrictJson one : json.list("projectors", 0, kMaxDevices)) {
    ShowFile::Projector& p = show.projectors.emplace_back();
    p.name = one.text("name", 200);
    p.lens = lens_of(one.at("lens"));
    p.scanned = pose_of<frame::Projector>(one.at("scanned"));
    p.applied = pose_of<frame::Projector>(one.at("applied"));
    if (one.has("learned")) {
      StrictJson learned = one.at("learned");
      p.learned = {pose_of<frame::Projector>(learned.at("believed")), pose_of<frame::Projector>(learned.at("at_rest")),
                   root_of(&learned)};
      learned.refuse_other_keys();
    }
    if (one.has("unplaced")) p.unplaced = one.text("unplaced", 1000);
    if (one.has("light_65535")) p.light = light_of(&one);
    one.refuse_other_keys();
  }
  for (StrictJson one : json.list("cameras", 0, kMaxDevices)) {
    ShowFile::Camera& c = show.cameras.emplace_back();
    c.name = one.text("name", 200);
    c.lens = lens_of(one.at("lens"));
    c.T_room_camera = pose_of<frame::Camera>(one.at("pose"));
    if (one.has("root")) c.root = root_of(&one);
    one.refuse_other_keys();
  }
  json.refuse_other_keys();
  TRY(mistakes.status(name));
  return show;
}

Result<ShowFile> read_show(const std::filesystem::path& path) {
  TRY_ASSIGN(const std::string text, read_text_file(path, kMaxBytes));
  return parse_show(text, path.filename().string());
}

Status write_show(const std::filesystem::path& path, const ShowFile& show) {
  return write_file_atomically(path, show_json(show));
}

}  // namespace cyclorama::calibration
