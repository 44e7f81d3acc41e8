// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "kiosk/tour/caption/caption_place.h"

namespace cyclorama::tour {

/// Texts and captions of a stop, from the visitor's arrival on. A value.
struct CaptionScript {
  struct Part {
    std::string language;
    std::string title;
    std::string text;
    std::vector<Cue> cues;  ///< In the order of their beginnings.
    friend bool operator==(const Part&, const Part&) = default;
  };
  std::vector<Part> parts;  ///< One for each language, from the top.
  TimePoint since{};        ///< Arrival at the stop, and the beginning of its narration.
  CaptionStyle style;
  CaptionWall wall;
};

/// The texts that are written at one time.
struct CaptionMoment {
  std::vector<CaptionText> texts;  ///< One for each part.
  TimePoint began_at{};            ///< Time from which these are written.
  std::optional<TimePoint> until;  ///< Time at which they change; nothing: they stay.
};

/// Returns what is written at `now`: while a part has a caption, that; between the first and the last of its captions
/// otherwise nothing; before, after and without any, the stop's title and text.
[[nodiscard]] CaptionMoment caption_at(const CaptionScript& script, TimePoint now);

/// Returns how long a page stays: a visitor who looks around reads about ten characters a second.
[[nodiscard]] Duration reading_time(std::size_t characters);

/// Returns the number of the page that is written `shown_for` after the first, and sets `*ret_left` to how long it stays;
/// the pages come again and again. One alone stays. Precondition: there are pages.
[[nodiscard]] std::size_t page_at(const std::vector<CaptionPage>& pages, Duration shown_for,
                                  std::optional<Duration>* ret_left);

}  // namespace cyclorama::tour
