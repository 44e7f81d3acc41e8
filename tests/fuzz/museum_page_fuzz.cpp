// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "kiosk/operator/calibration_controller.h"
#include "kiosk/operator/museum_routes.h"
#include "kiosk/operator/redaction.h"
#include "kiosk/operator/sessions.h"
#include "kiosk/update/update_status.h"

/// Input of browsers, the updater and peers; and a secret that must not appear in any output text.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  if (data[0] % 4 == 0) {
    static_cast<void>(operations::parse_calibration_request(text));
    static_cast<void>(operations::parse_hours_request(std::string(text)));
  } else if (data[0] % 4 == 1) {
    const auto status = update::parse_update_status(text);
    if (status && status->version.empty()) std::abort();
  } else if (data[0] % 4 == 2) {
    if (operations::network_of(std::string(text)).size() > text.size() + 40) std::abort();
  } else {
    constexpr std::string_view kSecret = "Zq81-secret-zq";
    operations::Redaction redaction;
    redaction.add_secret(kSecret);
    const std::size_t half = text.size() / 2;
    const std::string hidden =
        std::string(text.substr(0, half)) + std::string(kSecret) + std::string(text.substr(half));
    if (redaction.cleaned(hidden).find(kSecret) != std::string::npos) std::abort();
  }
  return 0;
}
