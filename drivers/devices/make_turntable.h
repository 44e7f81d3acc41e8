// SPDX-License-Identifier: Apache-2.0
/// Makes a turntable from one line of text, as used in a settings file or after --turntable:
///
///   # turntable
///   manual                                         # A person is asked to turn it.
///   serial:/dev/serial/by-id/usb-Arduino-if00      # A motor behind a G-code controller.
///   serial:/dev/ttyACM0?baud=115200&axis=X&units_per_turn=360&degrees_per_second=30&min_deg=-90&max_deg=90
#pragma once

#include <memory>
#include <string_view>

#include "drivers/turntable/manual/manual_turntable.h"

namespace cyclorama::devices {

/// `operated_by` is the operator of a manual turntable.
///
/// Errors: kInvalidArgument if the line itself is wrong (the message states what is valid); others are those of
/// turntable::SerialTurntable::open().
Result<std::unique_ptr<turntable::Turntable>> make_turntable(std::string_view spec,
                                                             std::unique_ptr<turntable::TurntableOperator> operated_by);

/// Checks the line without opening the turntable. Errors: kInvalidArgument if the line is wrong.
Status check_turntable(std::string_view spec);

}  // namespace cyclorama::devices
