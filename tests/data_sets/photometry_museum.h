// SPDX-License-Identifier: Apache-2.0
/// Brightness and colour of a simulated museum: photographed as in a scan, with the true geometry, so that photometry
/// is measured alone; and the view of a corrected wall from the sweet spot.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "appliance/photometry/photometry.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/museum/simulated_museum.h"
#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama {

struct MuseumLightOptions {
  int ramp_steps = photometry::kRampSteps;
  std::vector<double> exposures{photometry::kRampExposures.begin(),
                                photometry::kRampExposures.end()};  ///< Fractions of white's exposure.
  double black_exposure = photometry::kBlackExposure;               ///< Likewise.
  std::vector<double> angles_deg{-44.0, -22.0, 0.0, 22.0, 44.0};
  int map_cell_px = 8;
  int cell_px = 32;
};

/// Each projector's true map, continued slightly past the wall's rim as a measured one is.
calibration::MeasuredMap true_map(const simulated::TrueMuseum& museum, std::size_t projector, int cell_px);

struct MuseumLight {
  photometry::PhotometryInput input;
  int photographs = 0;
  double white_exposure_s = 0.0;
};
/// Photographs black, white and ramps, as scan_light() of appliance/scan does.
Result<MuseumLight> photograph_light(simulated::SimulatedMuseum* museum, const MuseumLightOptions& scan = {});

/// Response error over all projectors, channels and 8-bit codes, above black, as a fraction of full scale: the root
/// mean square of the worst channel.
double response_rms(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry);

/// Uniformity of a wall of one colour, seen from the sweet spot. Lines of sight of constant elevation and of constant
/// azimuth are sampled in steps of 0.1 degrees; a border is where the set of projectors that light the point changes.
///   step     luminance 0.45 degrees behind a border minus that 0.45 degrees before it, relative, at full white
///   jump     luminance difference at the border itself, relative, at full white: each side is extrapolated linearly
///            from the samples at 0.45 to 0.95 degrees (as far as the same projectors light; at least 0.05 to 0.45).
///            Changes within 0.45 degrees count as if they were at the border; a slope that continues beyond does not
///   bump     luminance in the middle of an overlap relative to the straight line between 0.45 degrees on either side
///            of it, at full white
///   delta_e  CIE 1976 L*a*b* between the pair of `step`, for linear content of 1, 0.2, 0.02 and 0, all together; the
///            reference white is the brightest full white on the wall
struct SeamScore {
  struct Border {
    Eigen::Vector2d at_deg = Eigen::Vector2d::Zero();  ///< Azimuth and elevation.
    bool is_upwards = false;                           ///< The line varies elevation; otherwise azimuth.
    unsigned before = 0;                               ///< Bit set of the projectors whose pictures contain the point.
    unsigned behind = 0;
    double step = 0.0;          ///< Signed: after minus before.
    double jump = 0.0;          ///< Likewise signed.
    double slope_before = 0.0;  ///< Relative slope per degree on that side.
    double slope_behind = 0.0;
  };
  std::vector<Border> borders{};
  std::size_t pairs = 0;
  double step_mean = 0.0;
  double step_p95 = 0.0;
  double step_max = 0.0;
  double jump_p95 = 0.0;
  double jump_max = 0.0;
  double bump_p95 = 0.0;
  double delta_e_mean = 0.0;
  double delta_e_p95 = 0.0;
  double delta_e_max = 0.0;
  double delta_e_black_p95 = 0.0;  ///< For content 0 alone.
  /// Maximum deviation from 1 of the sum of weights where several projectors light the wall, at least `rim_deg` from
  /// unlit parts: at the rim of the lit area, corners of pictures meet in points where any weights must jump; the
  /// weights change more slowly farther from these points.
  double mask_sum_error = 0.0;
  double mask_sum_error_rim = 0.0;  ///< Likewise, including the rim.
  double mask_off = 0.0;            ///< Fraction of points in overlaps, rim included, that are off by more than 0.005.
  /// Azimuth and elevation in degrees of the largest mask error and of the largest step.
  Eigen::Vector2d mask_worst_deg = Eigen::Vector2d::Zero();
  Eigen::Vector2d step_worst_deg = Eigen::Vector2d::Zero();
};
/// With `uses_photometry` false, scores the uncorrected wall: no mask, sRGB response.
/// 0.2 degrees are eight pixels of full HD.
SeamScore seam_score(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry,
                     bool uses_photometry = true, double rim_deg = 0.2);

/// Renders the wall with one linear grey as seen from the sweet spot: sRGB, azimuths of 65 degrees to either side and
/// elevations from -20 to 20, ten pixels per degree; `white_nits` maps to the maximum of sRGB.
RgbImage seen_wall(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry, double content,
                   double white_nits, bool uses_photometry);

}  // namespace cyclorama
