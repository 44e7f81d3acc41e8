// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/photometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "appliance/photometry/make_heads.h"
#include "appliance/photometry/response_solve.h"

namespace cyclorama::photometry {
namespace {

constexpr std::array<const char*, 3> kNames = {"red", "green", "blue"};
constexpr int kCameraSteps = 256;
// Thresholds above which the installer gets a remark.
constexpr double kBoost = 0.03;
constexpr double kColourSpread = 0.05;
constexpr double kDim = 0.5;
constexpr double kMaxBlackLevel = 1.0 / 200.0;
constexpr double kUnexplained = 0.02;
constexpr double kGamut = 0.6;

Error bad(std::string message) { return Error(ErrorCode::kInvalidArgument, std::move(message)); }

Status check(const ProjectorView& view, const PhotometryInput& input) {
  if (view.projector >= input.projectors.size())
    return bad(fmt::format("a view of projector {} of {}", view.projector, input.projectors.size()));
  const PhotometricProjector& projector = input.projectors[view.projector];
  const CameraCells& cells = view.cells;
  const bool fits = cells.width_px == projector.map.width_px && cells.height_px == projector.map.height_px &&
                    cells.cell_of.width() == input.camera_width_px && cells.cell_of.height() == input.camera_height_px;
  if (!fits) {
    return bad(
        fmt::format("projector '{}': cells of {}x{} px seen by a camera of {}x{} for a map of {}x{} px and a "
                    "camera of {}x{}; make both from the same scan",
                    projector.name, cells.width_px, cells.height_px, cells.cell_of.width(), cells.cell_of.height(),
                    projector.map.width_px, projector.map.height_px, input.camera_width_px, input.camera_height_px));
  }
  for (const LightReading& reading : view.readings) {
    const bool is_good = reading.codes.size() == cells.cells.size() && reading.level >= 0.0 && reading.level <= 1.0 &&
                         reading.exposure_s > 0.0 && std::isfinite(reading.exposure_s);
    if (!is_good)
      return bad(
          fmt::format("projector '{}': a reading with another number of cells than its view, a level outside of "
                      "0 to 1 or no exposure; make it by read_light()",
                      projector.name));
  }
  return Done{};
}

void remark_on(const PhotometryInput& input, const WallLighting& lighting, const CommonGamut* gamut,
               Photometry* result) {
  auto& remarks = result->remarks;
  for (std::size_t p = 0; p < input.projectors.size(); ++p) {
    const std::string whose = fmt::format("projector '{}'", input.projectors[p].name);
    const ProjectorLighting& projector = lighting.projectors[p];
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::string& remark :
           remarks_on(result->heads[p].response.at(c), fmt::format("{}, {}", whose, kNames.at(c))))
        remarks.push_back(std::move(remark));
    }
    if (std::abs(projector.white_boost - 1.0) > kBoost) {
      remarks.push_back(
          fmt::format("{}: white is {:.0f} % of red, green and blue together; turn off its modes that "
                      "change white or colours with the picture, then calibrate again",
                      whose, 100.0 * projector.white_boost));
    }
    if (projector.colour_spread > kColourSpread) {
      remarks.push_back(
          fmt::format("{}: its colours differ by {:.0f} % over its picture, which one matrix cannot even "
                      "out; use its own shading correction, or light the wall less from elsewhere",
                      whose, 100.0 * projector.colour_spread));
    }
    if (result->heads[p].brightness < kDim) {
      remarks.push_back(
          fmt::format("{} gives {:.0f} % of the brightest one's light, and its neighbours are dimmed "
                      "towards it; clean its filter, look after its lamp and its power mode",
                      whose, 100.0 * result->heads[p].brightness));
    }
    const double black_level = kCameraLuminance.dot(projector.black_level);
    if (black_level > kMaxBlackLevel) {
      remarks.push_back(
          fmt::format("{}: its black is 1/{:.0f} of its white; close its iris or choose a mode of more "
                      "contrast, since all others are lifted to it",
                      whose, 1.0 / black_level));
    }
  }
  if (lighting.unexplained > kUnexplained) {
    remarks.push_back(
        fmt::format("the same light differs by {:.1f} % from stop to stop; let the lamps warm up, keep "
                    "ambient light steady and the camera's gain fixed, then calibrate again",
                    100.0 * lighting.unexplained));
  }
  if (!lighting.has_vignetting) {
    remarks.emplace_back(
        "no place was seen from two stops of the camera, so what its lens darkens counts as the "
        "projectors'; let neighbouring stops see half of the same wall");
  }
  if (gamut == nullptr) {
    remarks.emplace_back("the camera sees no colours, so the projectors' were not matched; use a colour camera");
  } else if (gamut->area_kept < kGamut) {
    remarks.push_back(
        fmt::format("the projectors have only {:.0f} % of the smallest one's colours in common; choose "
                    "the same picture mode on all of them",
                    100.0 * gamut->area_kept));
  }
}

}  // namespace

Status PhotometryInput::validate() const {
  if (projectors.empty()) return bad("no projector; give each one its map");
  if (camera_width_px < 1 || camera_height_px < 1) return bad("a camera without pixels");
  if (!(code_step > 0.0 && code_step < 0.5))
    return bad(fmt::format("a camera's code step of {}; it is one over the largest code, 1/255 for 8 bits", code_step));
  if (camera_centre_px) {
    const Eigen::Vector2d size(camera_width_px, camera_height_px);
    const bool is_inside = camera_centre_px->minCoeff() >= 0.0 && (size - *camera_centre_px).minCoeff() >= 0.0;
    if (!is_inside) return bad("a camera whose axis lies outside of its picture; calibrate its lens again");
  }
  for (const ProjectorView& view : views) TRY(check(view, *this));
  return Done{};
}

Result<Photometry> photometry(const PhotometryInput& input, const PhotometryOptions& options) {
  for (const double slope : {options.max_slope_per_deg, options.max_slope_at_borders_per_deg}) {
    if (slope >= 0.0 && std::isfinite(slope)) continue;
    return bad("a slope of brightness below 0; 0 is flat, 0.02 is two percent per degree");
  }
  TRY(input.validate());
  std::vector<InverseMap> inverses;
  std::vector<std::string> names;
  for (const PhotometricProjector& projector : input.projectors) {
    auto inverse = InverseMap::make(projector.map);
    if (!inverse) return std::move(inverse).error().while_doing(fmt::format("projector '{}'", projector.name));
    inverses.push_back(*std::move(inverse));
    names.push_back(projector.name);
  }
  TRY_ASSIGN(const SolvedResponses responses, solve_responses(input));
  Photometry result;
  std::vector<std::array<ChannelResponse, 3>> curves(input.projectors.size());
  for (std::size_t p = 0; p < input.projectors.size(); ++p) {
    PhotometricHead& head = result.heads.emplace_back();
    std::array<warp::ResponseCurve, 3> inverse_curves;
    for (std::size_t c = 0; c < 3; ++c) {
      auto curve = channel_response(responses.channels[p].at(c));
      if (!curve) {
        return std::move(curve).error().while_doing(fmt::format("projector '{}', {}", names[p], kNames.at(c)));
      }
      curves[p].at(c) = *std::move(curve);
      inverse_curves.at(c) = curves[p].at(c).inverse();
    }
    head.response = curves[p];
    head.colour.response = std::move(inverse_curves);
  }
  TRY_ASSIGN(const WallLighting lighting, wall_lighting(input, responses, curves, inverses));
  std::optional<CommonGamut> gamut;
  if (input.has_colour) {
    std::vector<Eigen::Matrix3d> primaries;
    for (const ProjectorLighting& projector : lighting.projectors) primaries.push_back(projector.primaries);
    TRY_ASSIGN(gamut, common_gamut(primaries, kCameraLuminance, names));
  }
  const BlendWeights weights(input.projectors, inverses);
  const CommonGamut* const colours = gamut ? &*gamut : nullptr;
  TRY(make_heads(input, options, lighting, weights, colours, &result));
  for (int i = 0; i < kCameraSteps; ++i)
    result.camera_light.push_back(responses.camera.light_of(static_cast<double>(i) / (kCameraSteps - 1)));
  result.camera_dark_code = responses.camera.dark_code();
  result.camera_corner = std::exp(lighting.vignetting.sum());
  result.step_unexplained = lighting.unexplained;
  remark_on(input, lighting, colours, &result);
  result.lighting = std::make_shared<const WallLighting>(lighting);
  return result;
}

}  // namespace cyclorama::photometry
