// SPDX-License-Identifier: Apache-2.0
/// The file of an operator's override of the opening hours: rejected, or unchanged by a round trip and limited in time.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/opening/hours_override.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto parsed = parse_hours_override(text);
  if (parsed) {
    if (to_text(*parsed) != text || parsed->until - parsed->set_at > kMaxOverrideDuration) std::abort();
    if (parsed->holds(parsed->until) || parsed->holds(parsed->set_at - std::chrono::seconds(1))) std::abort();
  }
  // An override entered in the operator's page.
  const WallTime now{std::chrono::seconds(1795500000)};
  const auto until = open_until(OpeningHours(), text, now);
  if (!until) return 0;
  const auto again = parse_hours_override(to_text(*until));
  if (until->until <= now || !again || *again != *until) std::abort();
  return 0;
}
