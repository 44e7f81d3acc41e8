// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/light_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/file.h"
#include "common/json/strict_json.h"

namespace cyclorama::photometry {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr const char* kFile = "light.json";
constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr int kMaxPx = 16384;
constexpr int kMaxCells = 512;
constexpr std::size_t kMaxCoefficients = std::size_t{1} << 18;
constexpr double kMaxLog = 100.0;
constexpr double kLarge = 1e6;

template <typename Matrix>
Matrix matrix_of(const StrictJson& json) {
  Matrix matrix = Matrix::Zero();
  Eigen::Index r = 0;
  for (const StrictJson& row :
       json.elements(static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.rows()))) {
    Eigen::Index c = 0;
    for (const StrictJson& value :
         row.elements(static_cast<std::size_t>(matrix.cols()), static_cast<std::size_t>(matrix.cols())))
      matrix(r, c++) = value.as_number(-kLarge, kLarge);
    ++r;
  }
  return matrix;
}

ProjectorLighting lighting_of(StrictJson* json) {
  ProjectorLighting lighting;
  PictureField& white = lighting.log_white;
  white.width_px = json->integer("width_px", 16, kMaxPx);
  white.height_px = json->integer("height_px", 16, kMaxPx);
  white.cells_x = json->integer("cells_x", 1, kMaxCells);
  white.cells_y = json->integer("cells_y", 1, kMaxCells);
  const auto count = static_cast<std::size_t>(white.cells_x + 3) * static_cast<std::size_t>(white.cells_y + 3);
  for (const StrictJson& value : json->list("log_white", 1, kMaxCoefficients))
    white.coefficients.push_back(value.as_number(-kMaxLog, kMaxLog));
  if (white.coefficients.size() != count) {
    json->at("log_white")
        .refuse(fmt::format("has {} numbers and needs {}; calibrate again", white.coefficients.size(), count));
  }
  white.min = json->number("min", -kMaxLog, kMaxLog);
  white.max = json->number("max", -kMaxLog, kMaxLog);
  if (!(white.min <= white.max)) json->at("max").refuse("is below 'min'; calibrate again");
  lighting.primaries = matrix_of<Eigen::Matrix3d>(json->at("primaries"));
  Eigen::Index c = 0;
  for (const StrictJson& value : json->list("black_level", 3, 3)) lighting.black_level(c++) = value.as_number(0.0, 1.0);
  return lighting;
}

}  // namespace

std::string light_json(const SavedLight& light) {
  Json projectors = Json::array();
  for (std::size_t p = 0; p < light.names.size(); ++p) {
    const ProjectorLighting& one = light.lighting.projectors[p];
    projectors.push_back({{"name", light.names[p]},
                          {"width_px", one.log_white.width_px},
                          {"height_px", one.log_white.height_px},
                          {"cells_x", one.log_white.cells_x},
                          {"cells_y", one.log_white.cells_y},
                          {"log_white", one.log_white.coefficients},
                          {"min", one.log_white.min},
                          {"max", one.log_white.max},
                          {"primaries", rows_of(one.primaries)},
                          {"black_level", {one.black_level.x(), one.black_level.y(), one.black_level.z()}}});
  }
  const Json json{{"format", "cyclorama-light"},
                  {"version", kVersion},
                  {"ambient", rows_of(light.lighting.ambient)},
                  {"projectors", std::move(projectors)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<SavedLight> parse_light(std::string_view text, const std::string& name) {
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, "go back to a calibration that was kept"));
  StrictJson::Mistakes mistakes("calibrate again");
  StrictJson json(document, &mistakes);
  if (json.text("format", 60) != "cyclorama-light")
    json.at("format").refuse("is not 'cyclorama-light'; give another file");
  json.require_version(kVersion);
  SavedLight light;
  light.lighting.ambient = matrix_of<Eigen::Matrix<double, 3, 4>>(json.at("ambient"));
  std::set<std::string> names;
  for (StrictJson p : json.list("projectors", 1, 64)) {
    light.names.push_back(p.text("name", 200));
    if (!names.insert(light.names.back()).second) p.at("name").refuse("is another projector's name; give each its own");
    light.lighting.projectors.push_back(lighting_of(&p));
    p.refuse_other_keys();
  }
  json.refuse_other_keys();
  TRY(mistakes.status(name));
  return light;
}

Result<calibration::CalibrationPart> light_part(std::span<const calibration::CalibratedProjector> projectors,
                                                const WallLighting& lighting) {
  SavedLight light;
  for (const calibration::CalibratedProjector& projector : projectors) light.names.push_back(projector.name);
  if (light.names.size() != lighting.projectors.size())
    return Error(ErrorCode::kInvalidArgument, "not as many projectors as their light; calibrate again");
  light.lighting = lighting;
  return calibration::CalibrationPart{kFile, light_json(light)};
}

Result<WallLighting> read_light(const std::filesystem::path& own_folder) {
  TRY_ASSIGN(const std::string text, read_text_file(own_folder / kFile, kMaxBytes));
  TRY_ASSIGN(SavedLight light, parse_light(text, (own_folder / kFile).string()));
  return std::move(light.lighting);
}

}  // namespace cyclorama::photometry
