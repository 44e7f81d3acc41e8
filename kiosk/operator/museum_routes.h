// SPDX-License-Identifier: Apache-2.0
/// The operator page's requests that concern the museum rather than its processes.
///
///   GET  /museum                 {"level", "checks": [], "schedule", "provisioning", "update", ...}
///   POST /network-test           {"checks": []}; takes some seconds; 429: one runs
///   GET  /support-bundle.zip     429: one is being made
///   POST /calibration            {"do": "start"} and others of calibration_controller.h; 204, or {"date"}
///   POST /realign                {}; aligns the projectors anew (healing_controller.h); 204
///   GET  /calibration.jpg        the calibration camera's newest picture
///   POST /hours                  {"do": "open", "until": "22:00"}, "closed" (for today) or "settings"; 204
///   POST /alarm-test             {}; sends a test to everybody who gets alarms; 204, 429: one is being sent
///   POST /request                {"request": "update" | "factory-reset"}; 204
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "kiosk/operator/alarm_service.h"
#include "kiosk/operator/calibration_controller.h"
#include "kiosk/operator/care_log.h"
#include "kiosk/operator/healing_controller.h"
#include "kiosk/operator/museum_state.h"
#include "kiosk/operator/support_bundle.h"
#include "kiosk/operator/watch.h"

namespace httplib {
class Server;
}

namespace cyclorama::operations {

/// Must outlive the server. The pointers are borrowed and may be null; the page then reports that the feature is
/// missing.
struct MuseumServices {
  Watch* watch = nullptr;
  CalibrationController* calibration = nullptr;
  HealingController* healing = nullptr;
  AlarmService* alarms = nullptr;
  CareLog* log = nullptr;
  SupportOrder support;  ///< Includes the museum's state folder.
  /// Folder in which a file with the request's name triggers a systemd unit; empty: no requests.
  std::filesystem::path requests;
  /// File with the key that opens the museum's encrypted settings if the TPM does not, until it was shown; empty: none.
  std::filesystem::path recovery_key;
  std::string fingerprint;  ///< Fingerprint of the page's certificate; empty: none.
  std::atomic<bool> is_testing{false};
  std::atomic<bool> is_bundling{false};
  std::atomic<bool> is_sending{false};
};

/// Parses the body of POST /hours. Errors: kBadData for any other form.
Result<HoursRequest> parse_hours_request(const std::string& json);

void serve_museum(httplib::Server& server, MuseumServices* services);

}  // namespace cyclorama::operations
