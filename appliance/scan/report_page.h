// SPDX-License-Identifier: Apache-2.0
/// The installer's report of a calibration: one self-contained HTML page that loads nothing.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "appliance/solve/calibrate.h"

namespace cyclorama::scan {

/// Observed direction of a projector's pixel, and the map's error at this pixel, in projector pixels.
struct WallResidual {
  std::size_t projector = 0;  ///< Index in Calibration::projectors.
  Eigen::Vector3d direction;  ///< Eye frame, unit length.
  double error_px = 0.0;
};

/// Results that calibration.json does not contain. The page omits results that are absent.
struct ReportFindings {
  std::vector<WallResidual> residuals;
  struct Registration {
    double mean_px = 0.0;
    double p95_px = 0.0;
    std::size_t correspondences = 0;
  };
  std::optional<Registration> registration;
  struct Photograph {
    std::string caption;
    std::vector<std::byte> jpeg;
  };
  std::vector<Photograph> photographs;  ///< Pairs that are shown side by side: before and after.
};

/// Returns the page as HTML. Pure; reentrant.
[[nodiscard]] std::string report_page(const calibration::Calibration& calibration, const ReportFindings& findings = {});

/// Returns residuals of at most `max` correspondences, sampled evenly; correspondences outside the camera's lens or the
/// map are skipped. Precondition: the calibration was computed from these measurements.
[[nodiscard]] std::vector<WallResidual> wall_residuals(const solve::Measurements& measurements,
                                                       const calibration::Calibration& calibration,
                                                       std::size_t max = 6000);

/// Writes FOLDER/calibrations/DATE/report.html and returns its path. Errors: kSystem with the reason from errno.
Result<std::filesystem::path> write_report(const std::filesystem::path& folder,
                                           const calibration::Calibration& calibration, const ReportFindings& findings);

}  // namespace cyclorama::scan
