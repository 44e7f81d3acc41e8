// SPDX-License-Identifier: Apache-2.0
/// A turntable from one line of text, as it stands in a config file or behind --turntable:
///
///   # turntable
///   manual                                         # Somebody is asked to turn it.
///   serial:/dev/serial/by-id/usb-Arduino-if00      # A motor behind a controller that speaks G-code.
///   serial:/dev/ttyACM0?baud=115200&axis=X&units_per_turn=360&degrees_per_second=30&min_deg=-90&max_deg=90
#pragma once

#include <memory>
#include <string_view>

#include "drivers/turntable/manual/manual_turntable.h"

namespace cyclorama::turntable {

/// `operated_by` is who a manual one asks.
///
/// kInvalidArgument  the line itself is wrong and says what is legal. Others as SerialTurntable::open().
Result<std::unique_ptr<Turntable>> make_turntable(std::string_view spec,
                                                  std::unique_ptr<TurntableOperator> operated_by);

/// The line alone; nothing is opened. kInvalidArgument  as above.
Status check_turntable(std::string_view spec);

}  // namespace cyclorama::turntable
