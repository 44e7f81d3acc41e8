// SPDX-License-Identifier: Apache-2.0
/// Findings for the operator page's login, which is open to everybody: why nobody can log in.
///
///   no PIN in use     the result of the newest USB stick, whether this computer keeps its state in memory only,
///                     and the remedy, since a person in front of it can read them nowhere else
///   a PIN in use      nothing, since an unauthenticated peer must not learn anything
#pragma once

#include <vector>

#include "kiosk/operator/checks.h"
#include "kiosk/operator/museum_state.h"

namespace cyclorama::operations {

/// Returns false only if there is certainly no PIN: an unreadable or damaged PIN file still counts as a PIN.
[[nodiscard]] bool has_pin(const MuseumState& museum);
/// Returns the findings while no PIN is in use; never empty. Pure.
[[nodiscard]] std::vector<Check> login_checks(Findings findings);
/// Returns login_checks() of the museum on disk, or nothing while a PIN is in use.
[[nodiscard]] std::vector<Check> login_page_checks(const MuseumState& museum);

}  // namespace cyclorama::operations
