// SPDX-License-Identifier: Apache-2.0
/// Whether a picture was taken when it says. While the show moves, a camera's clock that is wrong looks like a bump of
/// all projectors at once; so what is shown a little earlier and a little later is compared with the picture too.
#pragma once

#include <span>

#include "appliance/healing/estimator/patch_alignment.h"
#include "common/base/clock.h"

namespace cyclorama::healing {

/// How far an exposure is moved to and fro: an error of half of it, or more, is found out.
inline constexpr Duration kTimeDoubt = std::chrono::milliseconds(20);

struct ExposureTiming {
  bool is_its_own = false;  ///< A projector, and most of those that tell, fit best at the time that was said.
  int towards = 0;          ///< -1: what was shown earlier fits better, 1: later; of all that tell.
};
/// Patches of predictions for the time that was said, and for a little earlier and later. Reentrant.
[[nodiscard]] ExposureTiming estimate_timing(std::span<const PatchShift> said, std::span<const PatchShift> earlier,
                                             std::span<const PatchShift> later, std::size_t projectors);

}  // namespace cyclorama::healing
