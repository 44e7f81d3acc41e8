// SPDX-License-Identifier: Apache-2.0
/// What a realignment starts from: the calibration that exists, and its reference projectors.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "appliance/calibration/calibration.h"
#include "appliance/photometry/inverse_map.h"
#include "appliance/scan/realign/reference_view.h"
#include "common/base/result.h"
#include "common/room/installation.h"

namespace cyclorama::scan {

/// The map of a projector that did not move.
struct ReferenceMap {
  std::size_t calibrated = 0;     ///< Index in the calibration.
  photometry::InverseMap pixels;  ///< From directions to its pixels.
};

/// A value. Reentrant.
struct RealignmentBaseline {
  calibration::Calibration calibration;
  calibration::BrownLens lens;       ///< The camera's.
  std::size_t target = 0;            ///< The displaced projector's index in the calibration,
  std::size_t target_installed = 0;  ///< and in the installation.
  std::vector<ReferenceProjector> references;
  std::vector<ReferenceMap> reference_maps;  ///< In the order of `references`.

  [[nodiscard]] const calibration::CalibratedProjector& projector() const { return calibration.projectors[target]; }
  /// Inverse distance of the wall along a unit vector, 1/m, as the camera's poses were found with it.
  [[nodiscard]] double camera_inverse_depth(const Eigen::Vector3d& direction) const;
  /// The same by the fitted wall; negative where it has none.
  [[nodiscard]] double wall_inverse_depth(const Eigen::Vector3d& direction) const;
};

/// kNotFound  there is no calibration in `folder`, or it does not have that projector.
/// kBadData   it was made with another camera or other projectors, or lacks the wall or a reference projector.
Result<RealignmentBaseline> read_baseline(const Installation& installation, const std::string& projector,
                                          const std::filesystem::path& folder, int camera_width_px,
                                          int camera_height_px);

/// kBadData with the remedy that always helps: to calibrate all projectors.
[[nodiscard]] Error realignment_refused(const std::string& what);

}  // namespace cyclorama::scan
