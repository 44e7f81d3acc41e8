// SPDX-License-Identifier: Apache-2.0
/// What the operator page asks of a museum besides its parts.
///
///   GET  /museum                 {"level", "checks": [], "schedule", "provisioning", "update", ...}
///   POST /network-test           {"checks": []}; takes some seconds; 429: one runs
///   GET  /support-bundle.zip     429: one is being made
///   POST /calibration            {"do": "start"}, as calibration_desk.h says; 204, or {"date"}
///   POST /realign                {}; has the projectors looked for anew (healing_desk.h); 204
///   GET  /calibration.jpg        what the calibration's camera saw last
///   POST /hours                  {"do": "open", "until": "22:00"}, "closed" (for today) or "settings"; 204
///   POST /wish                   {"wish": "update" | "factory-reset"}; 204
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "kiosk/operator/calibration_desk.h"
#include "kiosk/operator/healing_desk.h"
#include "kiosk/operator/museum_state.h"
#include "kiosk/operator/support_bundle.h"
#include "kiosk/operator/watch.h"

namespace httplib {
class Server;
}

namespace cyclorama {

/// Outlives the server. What is borrowed may be null: the page then says that it is not there.
struct MuseumDesk {
  Watch* watch = nullptr;
  CalibrationDesk* calibration = nullptr;
  HealingDesk* healing = nullptr;
  SupportOrder support;          ///< Names the museum's state folder.
  std::filesystem::path wishes;  ///< Where a file of the wish's name is made, for systemd to see; empty: none are.
  std::string fingerprint;       ///< Of the page's certificate; empty: none.
  std::atomic<bool> is_testing{false};
  std::atomic<bool> is_bundling{false};
};

/// kBadData  another form.
Result<HoursWish> parse_hours_wish(const std::string& json);

void serve_museum(httplib::Server& server, MuseumDesk* desk);

}  // namespace cyclorama
