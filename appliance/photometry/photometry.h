// SPDX-License-Identifier: Apache-2.0
/// From photographs of evenly lit projectors to one even wall: what each head must do to brightness and colour.
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
/// How a scan uses it (appliance/scan): the lamps are warm, the camera has no automatic exposure or gain.
///
///   e: an exposure at which the brightest projector's white is just not clipped (structured_light/exposure.h); all others dark.
///   at each stop of the turntable, for each projector that the camera sees there (Decoded says so):
///     cells = camera_cells(decoded, width, height)
///     show black and white, exposures kRampExposures * e; black also kBlackExposure * e
///     once per projector, at the stop that sees most of it, also ramps(width, height, kRampSteps, {kRed, kGreen,
///     kBlue}) each photograph: view.readings.push_back(*read_light(cells, photograph, picture, exposure))
///   photometry({camera's size, views, projectors with their maps})
///
/// Neighbouring stops should see half of the same wall: only that tells the camera's vignetting from the projectors'.
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

/// How many levels of each light a scan shows, and how much longer than the shortest its exposures are.
inline constexpr int kRampSteps = 17;
inline constexpr std::array<double, 2> kRampExposures = {1.0, 3.0};
/// Black is some thousandths of white. Cameras that cannot expose so long do what they can.
inline constexpr double kBlackExposure = 32.0;

struct PhotometryOptions {
  /// How much brightness may change over the wall, relative, per degree seen from the sweet spot. Eyes do not notice
  /// slopes of a few percent per degree. 0: flat, as dark as the darkest place.
  double max_slope_per_deg = 0.02;
  /// The same where a picture begins or ends upon another: there an eye looks for a step, and has an edge to hold the
  /// slope against. Chosen on the curve in docs/trade.md: with it 95 % of the steps across borders are below a percent.
  double max_slope_at_borders_per_deg = 0.01;
  bool lifts_black = true;
};

/// What one display head needs, and what was found out of its projector.
struct PhotometricHead {
  warp::HeadColour colour;  ///< For HeadPlan::colour.
  warp::MaskImage mask;     ///< For HeadPlan::mask: blend and evenness in one, linear light.
  warp::MaskImage weight;   ///< The blend alone: adds up to 1 over the projectors that light a place.
  std::array<ChannelResponse, 3> response;
  Eigen::Matrix3d primaries = Eigen::Matrix3d::Identity();  ///< Columns: its red, green, blue as the camera sees them;
                                                            ///< the luminance of white is 1.
  Eigen::Vector3d black = Eigen::Vector3d::Zero();          ///< What leaks at code 0, likewise, in parts of white.
  double brightness = 0.0;                                  ///< Of its middle, in parts of the brightest projector's.
};

struct WallLighting;

struct Photometry {
  std::vector<PhotometricHead> heads;                  ///< As PhotometryInput::projectors.
  Eigen::Matrix3d wall = Eigen::Matrix3d::Identity();  ///< The common primaries, as PhotometricHead::primaries.
  std::vector<double> camera_light;  ///< The camera's light for even steps of its code, 0 to 1; 1 at 1.
  double camera_dark_code = 0.0;     ///< Its code in darkness.
  double camera_corner = 1.0;        ///< What it sees of light in its corners, in parts of its middle.
  /// Of the light that the projectors could throw together, by area as seen; and what one brightness everywhere, as
  /// dark as the darkest place, would keep.
  double light_kept = 0.0;
  double light_kept_flat = 0.0;
  double step_unexplained = 0.0;     ///< Relative rms of what the model leaves of the readings of white.
  std::vector<std::string> remarks;  ///< For the installer: what is not as it could be, and what to do.

  /// What masks were made from: light_file.h keeps it.
  std::shared_ptr<const WallLighting> lighting{};
};

/// The one function to call. Takes seconds. Reentrant.
/// kInvalidArgument  counts or sizes that do not go together, no ramps of a projector, or exposures that are all alike:
/// names the projector and what to photograph.
/// kBadData  a projector or one of its channels without light, photographs all clipped or all dark: says which, and
/// what to look after.
/// No number of a result is ever NaN.
Result<Photometry> photometry(const PhotometryInput& input, const PhotometryOptions& options = {});

}  // namespace cyclorama::photometry
