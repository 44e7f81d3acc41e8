// SPDX-License-Identifier: Apache-2.0
/// Computes, from photographs of uniform pictures, the mask and colour correction of each head for a uniform wall.
///
///   ramps, several exposures ─▶ solve_responses() ─▶ camera's response, each channel's response
///                                                        │ light of every cell, as the camera sees it
///                                                        ▼
///                      camera's vignetting, each projector's light, primaries, black  (wall_lighting())
///                                                        │
///     MeasuredMap per projector ─▶ InverseMap ─▶ weights that add up to 1 ─▶ slowly varying brightness (target)
///                                                        │
///                                                        ▼
///                             mask = weight * target / light;  HeadColour {matrix, black, black_lift, response}
///
/// Use by a scan (appliance/scan). Preconditions: the lamps are warm, and the camera has no automatic exposure or gain.
///
///   e: an exposure at which the brightest projector's white is just not clipped (structured_light/exposure.h); all
///   other projectors are dark.
///   at each stop of the turntable, for each projector that the camera sees there (according to Decoded):
///     cells = camera_cells(decoded, width, height)
///     show black and white at exposures kRampExposures * e; black also at kBlackExposure * e
///     once per projector, at the stop that sees most of it, also ramps(width, height, kRampSteps, {kRed, kGreen,
///     kBlue}); for each photograph: view.readings.push_back(*read_light(cells, photograph, picture, exposure))
///   photometry({camera's size, views, projectors with their maps})
///
/// Neighbouring stops should share half of their view of the wall: this is required to separate the camera's vignetting
/// from that of the projectors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "appliance/photometry/channel_response.h"
#include "appliance/photometry/photometry_input.h"
#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// Number of levels of each light that a scan shows, and the exposures relative to the shortest one.
inline constexpr int kRampSteps = 17;
inline constexpr std::array<double, 2> kRampExposures = {1.0, 3.0};
/// Additional exposure of black, relative to the shortest one: black's light is some thousandths of white's. A camera
/// that cannot expose so long uses its longest exposure.
inline constexpr double kBlackExposure = 32.0;

struct PhotometryOptions {
  /// Maximum relative change of brightness over the wall, per degree seen from the sweet spot. Slopes of a few percent
  /// per degree are not noticed. 0 means uniform: as dark as the darkest point.
  double max_slope_per_deg = 0.02;
  /// Limit like max_slope_per_deg, but near borders of pictures inside other pictures, where a slope is more visible.
  /// Chosen by the measurements in docs/trade.md: with it 95 % of the steps across borders are below a percent.
  double max_slope_at_borders_per_deg = 0.01;
  bool lifts_black = true;
};

/// Settings of one display head, and measured properties of its projector.
struct PhotometricHead {
  warp::HeadColour colour;  ///< For HeadPlan::colour.
  warp::MaskImage mask;     ///< For HeadPlan::mask: blend times uniformity, in linear light.
  warp::MaskImage weight;   ///< Blend alone: adds up to 1 over the projectors at a point.
  std::array<ChannelResponse, 3> response;
  Eigen::Matrix3d primaries = Eigen::Matrix3d::Identity();  ///< Columns: red, green, blue as the camera sees them;
                                                            ///< white has luminance 1.
  /// Black level (light at code 0), as the camera sees it, as a fraction of white.
  Eigen::Vector3d black = Eigen::Vector3d::Zero();
  /// Brightness of the picture's middle relative to that of the brightest projector.
  double brightness = 0.0;
};

struct WallLighting;

struct Photometry {
  std::vector<PhotometricHead> heads;                  ///< In the order of PhotometryInput::projectors.
  Eigen::Matrix3d wall = Eigen::Matrix3d::Identity();  ///< Common primaries; see PhotometricHead::primaries.
  /// Camera's response: linear light at equally spaced codes from 0 to 1; 1 at code 1.
  std::vector<double> camera_light;
  double camera_dark_code = 0.0;  ///< Camera's code in darkness.
  /// Camera's vignetting: sensitivity in the corners relative to the middle.
  double camera_corner = 1.0;
  /// Used fraction of the light that the projectors could give together, weighted by solid angle; and the fraction that
  /// a uniform wall, as dark as the darkest point, would use.
  double light_kept = 0.0;
  double light_kept_flat = 0.0;
  double step_unexplained = 0.0;     ///< Relative RMS difference of white's readings from the model.
  std::vector<std::string> remarks;  ///< Shortcomings and their remedies, for the installer.

  /// Input of the masks; saved by light_file.h.
  std::shared_ptr<const WallLighting> lighting{};
};

/// Computes the settings of all heads. Takes seconds. Reentrant. No number of the result is NaN. Errors:
/// kInvalidArgument, with the projector's name and what to photograph, if counts or sizes are inconsistent, a projector
/// has no ramps, or all exposures are the same; kBadData, with the remedy, if a projector or one of its channels has no
/// light, or all photographs are clipped or dark.
Result<Photometry> photometry(const PhotometryInput& input, const PhotometryOptions& options = {});

}  // namespace cyclorama::photometry
