// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "common/language/catalogue.h"
#include "kiosk/care/alarm_registry.h"
#include "kiosk/care/care_settings.h"

namespace cyclorama::care {

/// Content of an alarm besides its fault.
struct AlarmSender {
  std::string museum;         ///< The museum's name; line breaks and other control characters are removed.
  std::string page;           ///< Address of the operator page; empty: unknown.
  const Catalogue& language;  ///< Borrowed.
};

/// Returns a message for SMTP (RFC 5322, in UTF-8 as base64), all alarms in one. `id` is unique for each message.
[[nodiscard]] std::string mail_text(std::span<const Alarm> alarms, const AlarmSender& sender, const MailSettings& mail,
                                    const std::string& id);

/// Returns {"museum", "alarms": [{"id", "state": "begun" | "over", "title", "sentence", "remedy", "since", "at"}]}.
[[nodiscard]] std::string webhook_json(std::span<const Alarm> alarms, const AlarmSender& sender);

}  // namespace cyclorama::care
