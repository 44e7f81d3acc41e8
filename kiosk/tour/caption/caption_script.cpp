// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/caption/caption_script.h"

#include <algorithm>

namespace cyclorama::tour {

CaptionMoment caption_at(const CaptionScript& script, TimePoint now) {
  const Duration time = now - script.since;
  CaptionMoment moment;
  moment.began_at = script.since;
  std::optional<Duration> until;
  const auto changes_at = [&](Duration change) {
    if (change <= time) {
      moment.began_at = std::max(moment.began_at, script.since + change);
    } else if (!until || change < *until) {
      until = change;
    }
  };
  for (const CaptionScript::Part& part : script.parts) {
    CaptionText text{part.language, part.title, part.text, false};
    const Cue* spoken = nullptr;
    for (const Cue& cue : part.cues) {
      changes_at(cue.begin);
      changes_at(cue.end);
      if (cue.begin <= time && time < cue.end) spoken = &cue;  // The later one, where two overlap.
    }
    const auto ends_later = [time](const Cue& cue) { return time < cue.end; };
    const bool is_narrated =
        !part.cues.empty() && time >= part.cues.front().begin && std::ranges::any_of(part.cues, ends_later);
    if (is_narrated) text = {part.language, "", spoken == nullptr ? "" : spoken->text, true};
    moment.texts.push_back(std::move(text));
  }
  if (until) moment.until = script.since + *until;
  return moment;
}

Duration reading_time(std::size_t characters) {
  constexpr double kPerSecond = 10.0;
  const double seconds = std::max(4.0, 1.0 + static_cast<double>(characters) / kPerSecond);
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

std::size_t page_at(const std::vector<CaptionPage>& pages, Duration shown_for, std::optional<Duration>* ret_left) {
  ret_left->reset();
  if (pages.size() == 1) return 0;
  Duration all{};
  for (const CaptionPage& page : pages) all += reading_time(page.characters);
  Duration in_round = shown_for % all;
  std::size_t number = 0;
  while (number + 1 < pages.size() && in_round >= reading_time(pages[number].characters))
    in_round -= reading_time(pages[number++].characters);
  *ret_left = reading_time(pages[number].characters) - in_round;
  return number;
}

}  // namespace cyclorama::tour
