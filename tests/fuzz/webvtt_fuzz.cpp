// SPDX-License-Identifier: Apache-2.0
/// Captions with their times, as a curator's other programs write them.
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "kiosk/tour/plan/characters.h"
#include "kiosk/tour/plan/webvtt.h"

using namespace cyclorama;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto cues = tour::parse_webvtt({reinterpret_cast<const char*>(data), size}, "a.vtt");
  if (!cues) {
    CHECK(cues.error().message().starts_with("a.vtt:"));
    return 0;
  }
  CHECK(cues->size() <= tour::kMaxCues);
  Duration before{};
  for (const tour::Cue& cue : *cues) {
    CHECK(cue.begin >= before && cue.end > cue.begin && cue.end <= tour::kMaxCueTime);
    CHECK(tour::character_count(cue.text) <= tour::kMaxCueCharacters);
    before = cue.begin;
  }
  return 0;
}
