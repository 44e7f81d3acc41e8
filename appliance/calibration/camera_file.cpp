// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/camera_file.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "common/json/strict_json.h"

namespace cyclorama::calibration {
namespace {

using Json = nlohmann::ordered_json;
using L = MeasuredLens;

constexpr std::size_t kMaxFileBytes = 1 << 20;
constexpr int kMaxPx = 16384;
constexpr const char* kValues = "focal_px_centre_px_k1_k2_k3_p1_p2";

}  // namespace

std::string camera_json(const CameraFile& camera) {
  Json covariance = Json::array();
  for (int r = 0; r < L::kParameters; ++r) {
    Json row = Json::array();
    for (int c = 0; c < L::kParameters; ++c) row.push_back(camera.lens.covariance(r, c));
    covariance.push_back(std::move(row));
  }
  Json values = Json::array();
  for (const double value : camera.lens.values) values.push_back(value);
  const Json json{{"format", "cyclorama-camera"},
                  {"version", 1},
                  {"camera", camera.camera},
                  {"date", camera.date},
                  {"width_px", camera.lens.width_px},
                  {"height_px", camera.lens.height_px},
                  {"lens", name_of(camera.model)},
                  {kValues, std::move(values)},
                  {"covariance", std::move(covariance)},
                  {"views", camera.views},
                  {"rms_px", camera.rms_px},
                  {"heldout_rms_px", camera.heldout_rms_px}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<CameraFile> parse_camera(std::string_view text, const std::string& name) {
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, "calibrate the camera again"));
  StrictJson::Mistakes mistakes("calibrate again");
  StrictJson json(document, &mistakes);
  CameraFile camera;
  if (json.text("format", 60) != "cyclorama-camera") {
    json.at("format").refuse("is not 'cyclorama-camera'; give a file of cyclorama calibrate-camera");
  }
  json.require_version(1);
  camera.camera = json.text("camera", 400);
  camera.date = json.text("date", 40);
  camera.lens.width_px = json.integer("width_px", 16, kMaxPx);
  camera.lens.height_px = json.integer("height_px", 16, kMaxPx);
  const auto model = lens_model(json.text("lens", 60));
  if (!model) json.at("lens").refuse("is no lens model; calibrate again");
  camera.model = model.value_or(LensModel::kPinhole);
  const auto values = json.numbers(kValues, L::kParameters, L::kParameters);
  std::copy(values.begin(), values.end(), camera.lens.values.begin());
  Eigen::Index r = 0;
  for (const StrictJson& row : json.list("covariance", L::kParameters, L::kParameters)) {
    Eigen::Index c = 0;
    for (const StrictJson& value : row.elements(L::kParameters, L::kParameters)) {
      camera.lens.covariance(r, c++) = value.as_number(-1e12, 1e12);
    }
    ++r;
  }
  camera.views = json.integer("views", 0, 1 << 20);
  camera.rms_px = json.number("rms_px", 0.0, 1e6);
  camera.heldout_rms_px = json.number("heldout_rms_px", 0.0, 1e6);
  json.refuse_other_keys();
  if (!mistakes.is_any) {
    const MeasuredLens::Covariance& cov = camera.lens.covariance;
    const double size = cov.cwiseAbs().maxCoeff();
    const MeasuredLens::Covariance raised = cov + 1e-9 * size * MeasuredLens::Covariance::Identity();
    if (!((cov - cov.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * size) || !raised.ldlt().isPositive()) {
      json.at("covariance").refuse("is no covariance; calibrate again");
    }
  }
  TRY(mistakes.status(name));
  const auto brown = camera.lens.brown();
  const Status covers = brown ? brown->covers_picture() : Status(brown.error());
  if (!covers) return Error(ErrorCode::kBadData, fmt::format("{}: {}", name, covers.error().message()));
  return camera;
}

Result<CameraFile> read_camera(const std::filesystem::path& path) {
  TRY_ASSIGN(const std::string text, read_text_file(path, kMaxFileBytes));
  return parse_camera(text, path.string());
}

Result<MeasuredLens> lens_for_picture(const MeasuredLens& lens, int width_px, int height_px) {
  const double across = static_cast<double>(width_px) / lens.width_px;
  const double down = static_cast<double>(height_px) / lens.height_px;
  constexpr double kSameShape = 0.005;
  if (!(across > 0.0) || !(std::abs(down - across) <= kSameShape * across)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("the lens was calibrated for pictures of {}x{} and these have {}x{}; take the same size, "
                             "or calibrate the camera for this one",
                             lens.width_px, lens.height_px, width_px, height_px));
  }
  MeasuredLens scaled = lens;
  scaled.width_px = width_px;
  scaled.height_px = height_px;
  MeasuredLens::Covariance by = MeasuredLens::Covariance::Identity();
  for (const int i : {L::kFocal, L::kCentreU, L::kCentreV}) by(i, i) = across;
  for (const int i : {L::kFocal, L::kCentreU, L::kCentreV}) scaled.values[static_cast<std::size_t>(i)] *= across;
  scaled.covariance = by * lens.covariance * by;
  return scaled;
}

}  // namespace cyclorama::calibration
