// SPDX-License-Identifier: Apache-2.0
/// What an installer reads after a calibration: one page of HTML that needs no other file and loads nothing.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "appliance/solve/calibrate.h"

namespace cyclorama::scan {

/// Where a projector's pixel was seen, and how far its map draws it from there, in its pixels.
struct WallResidual {
  std::size_t projector = 0;  ///< Counts Calibration::projectors.
  Eigen::Vector3d direction;  ///< Eye frame, unit length.
  double error_px = 0.0;
};

/// What a calibration's own file does not tell. What is absent is left out of the page.
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
  std::vector<Photograph> photographs;  ///< In twos, side by side: before and after.
};

/// Pure; reentrant.
[[nodiscard]] std::string report_page(const calibration::Calibration& calibration, const ReportFindings& findings = {});

/// Of at most `most` measurements, evenly taken; those where camera or map see nothing are left out. Precondition: the
/// calibration is of these measurements.
[[nodiscard]] std::vector<WallResidual> wall_residuals(const solve::Measurements& measurements,
                                                       const calibration::Calibration& calibration,
                                                       std::size_t max = 6000);

/// FOLDER/calibrations/DATE/report.html, and its path. kSystem  errno says why.
Result<std::filesystem::path> write_report(const std::filesystem::path& folder,
                                           const calibration::Calibration& calibration, const ReportFindings& findings);

}  // namespace cyclorama::scan
