// SPDX-License-Identifier: Apache-2.0
/// care.toml and the files of alarms: rejected, or the same after they were written and read again.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/base/check.h"
#include "kiosk/care/alarm_outbox.h"
#include "kiosk/care/alarm_registry.h"
#include "kiosk/care/care_settings.h"
#include "kiosk/care/fault_history.h"
#include "kiosk/care/visit_counts.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  if (data[0] % 5 == 0) {
    static_cast<void>(care::parse_care_settings(text, "care.toml"));
  } else if (data[0] % 5 == 3) {
    care::FaultHistory history;
    if (!history.read_json(text, "history.json")) return 0;
    care::FaultHistory again;
    CHECK(again.read_json(history.to_json(), "history.json") && again.to_json() == history.to_json());
  } else if (data[0] % 5 == 4) {
    care::VisitCounts counts;
    if (!counts.read_json(text, "visits.json")) return 0;
    care::VisitCounts again;
    CHECK(again.read_json(counts.to_json(), "visits.json") && again.days() == counts.days());
  } else if (data[0] % 5 == 1) {
    care::AlarmRegistry registry;
    if (!registry.read_json(text, "alarms.json")) return 0;
    care::AlarmRegistry again;
    CHECK(again.read_json(registry.to_json(), "alarms.json") && again.to_json() == registry.to_json());
    registry.update({}, {}, care::WallSeconds());
  } else {
    care::AlarmOutbox outbox;
    if (!outbox.read_json(text, "alarms-waiting.json")) return 0;
    care::AlarmOutbox again;
    CHECK(again.read_json(outbox.to_json(), "alarms-waiting.json") && again.to_json() == outbox.to_json());
  }
  return 0;
}
