// SPDX-License-Identifier: Apache-2.0
/// What is told at the operator page's door, before anybody entered: why nobody can.
///
///   no PIN in use     what became of the stick, whether this computer forgets what it is told, and what helps: who
///                     stands before it can read it nowhere else
///   a PIN in use      nothing: it would tell strangers something
#pragma once

#include <vector>

#include "kiosk/operator/checks.h"
#include "kiosk/operator/museum_state.h"

namespace cyclorama {

/// False only where there surely is none: one that cannot be read, or is damaged, is a PIN.
[[nodiscard]] bool has_pin(const MuseumState& museum);
/// While no PIN is in use; never empty. Pure.
[[nodiscard]] std::vector<Check> door_checks(Findings findings);
/// The two above, of the disk: none while a PIN is in use.
[[nodiscard]] std::vector<Check> told_at_the_door(const MuseumState& museum);

}  // namespace cyclorama
