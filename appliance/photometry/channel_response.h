// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "appliance/warp/head_colour.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// A measured point of a channel's response.
struct ResponsePoint {
  double level = 0.0;  ///< Code value, 0 to 1.
  double light = 0.0;  ///< Above black, in parts of the channel's most.
  double sigma = 0.0;
};

/// What light a projector's channel makes of each code value: 0 at 0, 1 at its brightest. A value; reentrant.
struct ChannelResponse {
  std::vector<double> light;           ///< At even steps of the code value from 0 to 1; at least two. Any shape.
  double sigma = 0.0;                  ///< Of `light`, root mean square over the measured points.
  std::optional<double> flat_above{};  ///< Code value from which on nothing gets brighter.
  std::optional<double> dark_below{};  ///< Code value up to which nothing shines.
  std::optional<double> falls_at{};    ///< Code value from which the light falls although the code grows.

  [[nodiscard]] double light_of(double level) const;
  /// The least code value that makes a light: exact for every continuous response, also where it falls for a while,
  /// since then the codes past the first crossing are not used.
  [[nodiscard]] warp::ResponseCurve inverse(std::size_t steps = 1024) const;
};

/// A smooth curve through the points, monotone where they are. kInvalidArgument  less than 3 points, levels that do
/// not rise from 0 to 1, or none that shines. Reentrant.
Result<ChannelResponse> channel_response(std::span<const ResponsePoint> points);

/// What is wrong with it, and what to do, for the installer; empty: nothing. `whose` is "projector 'left', red".
[[nodiscard]] std::vector<std::string> remarks_on(const ChannelResponse& response, const std::string& whose);

}  // namespace cyclorama::photometry
