// SPDX-License-Identifier: Apache-2.0
/// A folder that grows, kept within bounds: the oldest goes first, and never what is in use.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

struct TidyLimits {
  std::uint64_t most_bytes = 0;  ///< Of the whole folder; 0: any.
  std::uint64_t least_free = 0;  ///< On its disk; 0: any.
  std::size_t keep = 2;          ///< So many of the newest stay, whatever they take.
};

/// One entry of the folder, with all that lies in it.
struct TidyEntry {
  std::string name;
  std::uint64_t bytes = 0;
  std::int64_t changed_s = 0;  ///< Unix time of the newest file in it.
  bool is_in_use = false;      ///< A link in the folder, or beside it, leads to it.

  bool operator==(const TidyEntry&) const = default;
};

/// What must go, the oldest first. Pure.
///   1. What is in use, and the newest `keep` besides, never are.   2. No more goes than the limits ask for.
[[nodiscard]] std::vector<TidyEntry> too_much(std::vector<TidyEntry> entries, const TidyLimits& limits,
                                              std::uint64_t free_bytes);

/// Links are not entries, but say what is in use; they are never followed out of the folder. kNotFound  no such folder.
Result<std::vector<TidyEntry>> entries_of(const std::filesystem::path& folder);

/// Looks, and removes. What was removed; what could not be is left, and tried again the next time.
Result<std::vector<TidyEntry>> tidy(const std::filesystem::path& folder, const TidyLimits& limits, bool only_look);

}  // namespace cyclorama
