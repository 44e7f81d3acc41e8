// SPDX-License-Identifier: Apache-2.0
/// State of this computer's software updates: written by the image's updater, shown by the operator page.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::update {

inline constexpr const char* kUpdateStatusFile = "update.json";

/// update.json: {"state": "...", "version": "0.1.0", "available": "0.2.0", "at": "2026-11-22T03:10:00Z", "sentence":
/// "..."}; `state` and `version` are required, other keys are ignored, so that an older page can read the file of a
/// newer updater.
struct UpdateStatus {
  enum class State {
    kCurrent,   ///< Nothing newer is known.
    kChecking,  ///< Looks for a newer version.
    kLoading,   ///< Fetches the version and writes it to the other half of the disk.
    kReady,     ///< Written; used from the next start, at night.
    /// Could not be fetched, or is not signed with our key; the sentence has the reason. Retried automatically.
    kFailed,
    kRolledBack,  ///< The version did not start well, and the previous one runs again.
  };
  State state = State::kCurrent;
  std::string version;    ///< The running version.
  std::string available;  ///< A newer version; empty: none.
  std::string at;         ///< Time of writing.
  std::string sentence;   ///< Further information; may be empty.
};

[[nodiscard]] std::string_view to_text(UpdateStatus::State state);  ///< "current", ..., "rolled-back".
/// Errors: kBadData if the text is not the JSON of a status.
Result<UpdateStatus> parse_update_status(std::string_view json);

}  // namespace cyclorama::update
