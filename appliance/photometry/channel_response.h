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
  double light = 0.0;  ///< Above black, as a fraction of the channel's maximum.
  double sigma = 0.0;
};

/// Response of a projector's channel: light for each code value, 0 at code 0 and 1 at its maximum. A value; reentrant.
struct ChannelResponse {
  std::vector<double> light;           ///< At equal steps of the code value from 0 to 1; at least two values.
  double sigma = 0.0;                  ///< Standard deviation of `light`: RMS over the measured points.
  std::optional<double> flat_above{};  ///< Code value above which the light no longer increases.
  std::optional<double> dark_below{};  ///< Code value up to which the channel gives no light.
  std::optional<double> falls_at{};    ///< Code value above which the light decreases as the code grows.

  [[nodiscard]] double light_of(double level) const;
  /// Returns the smallest code value for each light. This inverts every continuous response, even one that decreases in
  /// between, because only the first crossing of each light is used.
  [[nodiscard]] warp::ResponseCurve inverse(std::size_t steps = 1024) const;
};

/// Fits a smooth curve through the points; it is monotone where the points are. Errors: kInvalidArgument if there are
/// fewer than 3 points, the levels do not increase from 0 to 1, or no point has light. Reentrant.
Result<ChannelResponse> channel_response(std::span<const ResponsePoint> points);

/// Returns defects of the response with their remedies, for the installer; empty if there are none. `whose` is, for
/// example, "projector 'left', red".
[[nodiscard]] std::vector<std::string> remarks_on(const ChannelResponse& response, const std::string& whose);

}  // namespace cyclorama::photometry
