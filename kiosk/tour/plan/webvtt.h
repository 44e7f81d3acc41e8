// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"

namespace cyclorama::tour {

/// A caption with its time, which counts from the beginning of the narration.
struct Cue {
  Duration begin{};
  Duration end{};
  std::string text;  ///< Without markup; its lines are separated by '\n'.
  friend bool operator==(const Cue&, const Cue&) = default;
};

inline constexpr std::size_t kMaxCues = 2000;
inline constexpr std::size_t kMaxCueCharacters = 300;  ///< More than a visitor reads in the time of a caption.
inline constexpr std::size_t kMaxCueFileBytes = std::size_t{1} << 20;
inline constexpr Duration kMaxCueTime = std::chrono::hours(1);

/// Reads captions in WebVTT (www.w3.org/TR/webvtt1). Tags in a caption's text (voices, italics) are left out, as are
/// styles, regions, comments, and the positions of captions, which the wall decides. `name` stands for the file in
/// errors. Errors: kBadData with file, line and remedy.
Result<std::vector<Cue>> parse_webvtt(std::string_view text, const std::string& name);

}  // namespace cyclorama::tour
