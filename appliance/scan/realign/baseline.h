// SPDX-License-Identifier: Apache-2.0
/// Baseline of a realignment: the existing calibration and its reference projectors.
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
  photometry::InverseMap pixels;  ///< Maps directions to the projector's pixels.
};

/// A value. Reentrant.
struct RealignmentBaseline {
  calibration::Calibration calibration;
  calibration::BrownLens lens;       ///< Lens of the camera.
  std::size_t target = 0;            ///< Index of the displaced projector in the calibration.
  std::size_t target_installed = 0;  ///< Index of the displaced projector in the installation.
  std::vector<ReferenceProjector> references;
  std::vector<ReferenceMap> reference_maps;  ///< In the order of `references`.

  [[nodiscard]] const calibration::CalibratedProjector& projector() const { return calibration.projectors[target]; }
  /// Returns the inverse distance of the wall along a unit vector, 1/m, as used when the camera's poses were estimated.
  [[nodiscard]] double camera_inverse_depth(const Eigen::Vector3d& direction) const;
  /// Returns the inverse distance of the fitted wall along a unit vector, 1/m; negative where the wall has none.
  [[nodiscard]] double wall_inverse_depth(const Eigen::Vector3d& direction) const;
};

/// Reads the baseline for a displaced projector. Errors: kNotFound if `folder` has no calibration or the calibration
/// lacks that projector; kBadData if the calibration was made with another camera or other projectors, or lacks the
/// wall or a reference projector.
Result<RealignmentBaseline> read_baseline(const Installation& installation, const std::string& projector,
                                          const std::filesystem::path& folder, int camera_width_px,
                                          int camera_height_px);

/// Returns the error kBadData for `what`, with the remedy to calibrate all projectors.
[[nodiscard]] Error realignment_refused(const std::string& what);

}  // namespace cyclorama::scan
