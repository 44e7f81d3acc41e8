// SPDX-License-Identifier: Apache-2.0
/// How the software of this computer is kept up to date: written by the image's updater, shown by the operator page.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

inline constexpr const char* kUpdateStatusFile = "update.json";

/// update.json: {"state": "...", "version": "0.1.0", "available": "0.2.0", "at": "2026-11-22T03:10:00Z", "sentence":
/// "..."}; `state` and `version` are required, other keys are ignored, so that an older page reads a newer updater's
/// file.
struct UpdateStatus {
  enum class State {
    kCurrent,     ///< Nothing newer is known.
    kChecking,    ///< Looks for one.
    kLoading,     ///< Fetches and writes it to the other half of the disk.
    kReady,       ///< Begins with the next start, at night.
    kFailed,      ///< Could not be fetched or is not signed by us; the sentence says why. Tried again by itself.
    kRolledBack,  ///< It did not start well, and the version before runs again.
  };
  State state = State::kCurrent;
  std::string version;    ///< That runs.
  std::string available;  ///< That is newer; empty: none.
  std::string at;         ///< When this was written.
  std::string sentence;   ///< What there is to say besides; may be empty.
};

[[nodiscard]] std::string_view to_text(UpdateStatus::State state);  ///< "current", ..., "rolled-back".
/// kBadData  not such JSON.
Result<UpdateStatus> parse_update_status(std::string_view json);

}  // namespace cyclorama
