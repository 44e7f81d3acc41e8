// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "appliance/calibration/calibration_file.h"
#include "appliance/solve/turntable_problem.h"

namespace cyclorama::scan {
namespace {

constexpr const char* kAll = "; calibrate all projectors";

std::optional<std::size_t> installed(const Installation& installation, const std::string& name) {
  const auto at =
      std::ranges::find(installation.projectors, name, [](const auto& p) -> const std::string& { return p.name; });
  if (at == installation.projectors.end()) return std::nullopt;
  return static_cast<std::size_t>(at - installation.projectors.begin());
}

bool is_of_size(const calibration::MeasuredMap& map, const Pinhole& format) {
  return format.width_px == map.width_px && format.height_px == map.height_px;
}

Result<calibration::Calibration> read_existing(const std::filesystem::path& folder) {
  auto calibration = calibration::read_calibration(folder);
  if (calibration) return calibration;
  const std::string why = calibration.error().message();
  if (calibration.error().code() == ErrorCode::kNotFound)
    return Error(ErrorCode::kNotFound, fmt::format("there is no previous calibration ({}){}", why, kAll));
  return std::move(calibration).error().while_doing("reading the previous calibration");
}

}  // namespace

Error realignment_refused(const std::string& what) { return Error(ErrorCode::kBadData, what + kAll); }

double RealignmentBaseline::camera_inverse_depth(const Eigen::Vector3d& direction) const {
  const calibration::CalibratedTurntable& turntable = calibration.turntable;
  return solve::InverseDepthField{turntable.inverse_depth, turntable.wall ? &*turntable.wall : nullptr}.at(direction);
}

double RealignmentBaseline::wall_inverse_depth(const Eigen::Vector3d& direction) const {
  return calibration.wall->fit.surface.inverse_depth_at(direction).value_or(-1.0);
}

Result<RealignmentBaseline> read_baseline(const Installation& installation, const std::string& projector,
                                          const std::filesystem::path& folder, int camera_width_px,
                                          int camera_height_px) {
  TRY_ASSIGN(calibration::Calibration calibration, read_existing(folder));
  const auto& all = calibration.projectors;
  const auto at = std::ranges::find(all, projector, &calibration::CalibratedProjector::name);
  const auto target_installed = installed(installation, projector);
  if (at == all.end() || !target_installed) {
    return Error(ErrorCode::kNotFound, fmt::format("no projector '{}' was calibrated before{}", projector, kAll));
  }
  const auto target = static_cast<std::size_t>(at - all.begin());
  const calibration::MeasuredLens& camera = calibration.turntable.camera;
  if (camera.width_px != camera_width_px || camera.height_px != camera_height_px)
    return realignment_refused("the previous calibration was made with another camera");
  if (!calibration.wall) return realignment_refused("the previous calibration lacks the wall's shape");
  TRY_ASSIGN(calibration::BrownLens lens, camera.brown());
  std::vector<ReferenceProjector> references;
  std::vector<ReferenceMap> maps;
  for (std::size_t p = 0; p < all.size(); ++p) {
    const auto number = installed(installation, all[p].name);
    if (p == target || !number) continue;
    const Pinhole& format = installation.projectors[*number].lens;
    if (!is_of_size(all[p].map, format)) continue;
    auto inverse = photometry::InverseMap::make(all[p].map);
    if (!inverse) continue;
    references.push_back({*number, format.width_px, format.height_px});
    maps.push_back({p, *std::move(inverse)});
  }
  if (references.empty()) {
    return realignment_refused(
        fmt::format("projector '{}' has no neighbour that shows the pose of the camera", projector));
  }
  if (!is_of_size(at->map, installation.projectors[*target_installed].lens))
    return realignment_refused(fmt::format("projector '{}' has another number of pixels than before", projector));
  return RealignmentBaseline{std::move(calibration), std::move(lens),       target,
                             *target_installed,      std::move(references), std::move(maps)};
}

}  // namespace cyclorama::scan
