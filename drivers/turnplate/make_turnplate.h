// SPDX-License-Identifier: Apache-2.0
/// A turn-plate from one line of text, as it stands in a config file or behind --turnplate:
///
///   # turntable
///   manual                                         # Somebody is asked to turn it.
///   serial:/dev/serial/by-id/usb-Arduino-if00      # A motor behind a controller that speaks G-code.
///   serial:/dev/ttyACM0?baud=115200&axis=X&units_per_turn=360&degrees_per_second=30&min_deg=-90&max_deg=90
#pragma once

#include <memory>
#include <string_view>

#include "drivers/turnplate/manual/manual_turnplate.h"

namespace cyclorama::turnplate {

/// `operated_by` is who a manual one asks.
///
/// kInvalidArgument  the line itself is wrong and says what is legal. Others as SerialTurnplate::open().
Result<std::unique_ptr<Turnplate>> make_turnplate(std::string_view spec,
                                                  std::unique_ptr<TurnplateOperator> operated_by);

/// The line alone; nothing is opened. kInvalidArgument  as above.
Status check_turnplate(std::string_view spec);

}  // namespace cyclorama::turnplate
