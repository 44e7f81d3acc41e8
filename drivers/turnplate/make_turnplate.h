// SPDX-License-Identifier: Apache-2.0
/// A turn-plate from one line of text, as it stands in a config file or behind --turnplate:
///
///   serial:DEVICE[?baud=N][&axis=X][&units_per_turn=N][&degrees_per_second=N][&least_deg=N][&most_deg=N]
///   manual        asks somebody to turn it
#pragma once

#include <memory>
#include <string_view>

#include "drivers/turnplate/manual/manual_turnplate.h"

namespace cyclorama {

/// `operated_by` is who a manual one asks.
///
/// kInvalidArgument  the line itself is wrong and says what is legal. Others as SerialTurnplate::open().
Result<std::unique_ptr<Turnplate>> make_turnplate(std::string_view spec,
                                                  std::unique_ptr<TurnplateOperator> operated_by);

/// The line alone; nothing is opened. kInvalidArgument  as above.
Status check_turnplate(std::string_view spec);

}  // namespace cyclorama
