// SPDX-License-Identifier: Apache-2.0
/// Brightness and colour of a simulated museum: photographed as a scan would, with the geometry told by the truth so
/// that photometry is measured alone; and what an eye at the sweet spot sees of a corrected wall.
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
                                photometry::kRampExposures.end()};  ///< In parts of white's.
  double black_exposure = photometry::kBlackExposure;               ///< Likewise.
  std::vector<double> angles_deg{-44.0, -22.0, 0.0, 22.0, 44.0};
  int map_cell_px = 8;
  int cell_px = 32;
};

/// Each projector's map as the truth has it, continued a little past the wall's rim as a measured one is.
calibration::MeasuredMap true_map(const simulated::TrueMuseum& museum, std::size_t projector, int cell_px);

struct MuseumLight {
  photometry::PhotometryInput input;
  int photographs = 0;
  double white_exposure_s = 0.0;
};
/// Black, white and ramps, as scan_light() of appliance/scan photographs them.
Result<MuseumLight> photograph_light(simulated::SimulatedMuseum* museum, const MuseumLightOptions& scan = {});

/// Of every projector, channel and code of 8 bits, above black, in parts of full scale: the worst channel's root mean
/// square.
double response_rms(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry);

/// Of a wall of one colour, seen from the sweet spot. Lines of sight of even elevation and of even azimuth are walked
/// in steps of 0.1 degrees; a border is where the set of projectors changes whose pictures hold the place.
///   step     of luminance between 0.45 degrees before a border and 0.45 degrees behind it, relative, at full white
///   jump     of luminance at the border itself, relative, at full white: each side is continued to it along a straight
///            line through 0.45 to 0.95 degrees (as far as the same projectors light; at least 0.05 to 0.45). What
///            happens within 0.45 degrees counts as at the border; a slope that goes on beyond does not
///   bump     of luminance in the middle of an overlap against the straight line between 0.45 degrees on either side of
///            it, relative, at full white
///   delta_e  CIE 1976 L*a*b* between the pair of `step`, for linear content of 1, 0.2, 0.02 and 0, all together; the
///            reference white is the brightest full white on the wall
struct SeamScore {
  struct Border {
    Eigen::Vector2d at_deg = Eigen::Vector2d::Zero();  ///< Azimuth, elevation.
    bool is_upwards = false;                           ///< Walked by elevation; else by azimuth.
    unsigned before = 0;                               ///< A bit per projector whose picture holds the place.
    unsigned behind = 0;
    double step = 0.0;          ///< With its sign: behind less before.
    double jump = 0.0;          ///< Likewise.
    double slope_before = 0.0;  ///< Relative, per degree: of the line on that side.
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
  double delta_e_black_p95 = 0.0;  ///< Of content 0 alone.
  /// The largest difference from 1 of the weights where two projectors or more light, `rim_deg` and more from where
  /// nobody does: at the rim of all that is lit corners of pictures touch in points, where any weights must jump, and
  /// change the slower the more pixels one is away.
  double mask_sum_error = 0.0;
  double mask_sum_error_rim = 0.0;  ///< Up to the very rim.
  double mask_off = 0.0;            ///< Of the places in overlaps, rim included: the part that is off by over 0.005.
  /// Azimuth and elevation, degrees: where the masks are worst, and where the step is.
  Eigen::Vector2d mask_worst_deg = Eigen::Vector2d::Zero();
  Eigen::Vector2d step_worst_deg = Eigen::Vector2d::Zero();
};
/// `uses_photometry` false: what the wall looks like without: no mask, sRGB.
/// 0.2 degrees are eight pixels of full HD.
SeamScore seam_score(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry,
                     bool uses_photometry = true, double rim_deg = 0.2);

/// The wall with one linear grey on it, as an eye at the sweet spot sees it: sRGB, azimuths of 65 degrees to either
/// side and elevations from -20 to 20, ten pixels a degree; `white_nits` is as bright as sRGB goes.
RgbImage seen_wall(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry, double content,
                   double white_nits, bool uses_photometry);

}  // namespace cyclorama
