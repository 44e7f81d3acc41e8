// SPDX-License-Identifier: Apache-2.0
/// Checks whether a picture was taken at its time stamp. While the show moves, a wrong camera clock looks like a bump
/// of all projectors at once. The picture is therefore also compared with the content shown a little earlier and a
/// little later.
#pragma once

#include <span>

#include "appliance/healing/estimator/patch_alignment.h"
#include "common/base/clock.h"

namespace cyclorama::healing {

/// Time by which an exposure is shifted, earlier and later, for comparison; a clock error of at least half of this time
/// is detected.
inline constexpr Duration kTimeDoubt = std::chrono::milliseconds(20);

struct ExposureTiming {
  bool is_its_own = false;  ///< True if at least half of the projectors' results favour the time stamp.
  int towards = 0;          ///< -1 if all results favour earlier content, 1 if later content, else 0.
};
/// Compares the patches of three predictions: for the time stamp (`said`), an earlier and a later time. Reentrant.
[[nodiscard]] ExposureTiming estimate_timing(std::span<const PatchShift> said, std::span<const PatchShift> earlier,
                                             std::span<const PatchShift> later, std::size_t projectors);

}  // namespace cyclorama::healing
