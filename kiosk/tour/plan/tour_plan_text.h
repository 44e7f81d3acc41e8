// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kiosk/tour/plan/tour_plan.h"

namespace cyclorama::tour {

/// Returns the text of a tour.toml that parses to the same plan.
[[nodiscard]] std::string to_toml(const TourPlan& plan);

/// Returns the text of one [[stop]], to be appended to a tour.toml.
[[nodiscard]] std::string to_toml(const PlannedStop& stop);

}  // namespace cyclorama::tour
