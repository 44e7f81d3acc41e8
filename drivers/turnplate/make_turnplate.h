// SPDX-License-Identifier: Apache-2.0
/// A turn-plate from one line of text, as it stands in a config file or behind --turnplate:
///
///   serial:DEVICE[?baud=N][&axis=X][&units_per_turn=N][&degrees_per_second=N][&least_deg=N][&most_deg=N]
///   manual        asks on the terminal
#pragma once

#include <memory>
#include <string_view>

#include "drivers/turnplate/turnplate.h"

namespace cyclorama {

/// kInvalidArgument  the line itself is wrong and says what is legal. Others as SerialTurnplate::open().
Result<std::unique_ptr<Turnplate>> make_turnplate(std::string_view spec);

}  // namespace cyclorama
