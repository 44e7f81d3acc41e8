// SPDX-License-Identifier: Apache-2.0
/// care.toml: the museum's language, and who gets its alarms. The operator page reads it.
///
///   # care.toml
///   language = "de"                     # Of the wall, and of the page where nobody has chosen another.
///   [alarms]
///   after_s = 120                       # A fault that lasts this long is reported, and its end likewise.
///   quiet = "22:00-07:00"               # The museum's time. Alarms of these hours wait for their end.
///   level = "fault"                     # "warning": warnings, too.
///   [alarms.mail]
///   server = "smtp.example.org:587"
///   security = "starttls"               # "tls", or "none" for a server on this computer.
///   user = "wall@example.org"           # Left out: no login.
///   password_file = "mail-password"
///   from = "wall@example.org"
///   to = ["technician@example.org"]
///   [alarms.webhook]
///   url = "https://alarms.example.org/cyclorama"
///   token_file = "webhook-token"        # Sent as "Authorization: Bearer ..."; left out: none.
///   [metrics]
///   token_file = "metrics-token"        # Lets Prometheus read /metrics without a PIN; left out: nobody.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::care {

inline constexpr const char* kCareFile = "care.toml";
/// A shorter token could be guessed.
inline constexpr std::size_t kMinMetricsToken = 16;

/// Hours of each day, in minutes since midnight; over midnight where `from` is later than `to`.
struct QuietHours {
  int from = 0;
  int to = 0;
  [[nodiscard]] bool contains(int minute_of_day) const {
    return from <= to ? from <= minute_of_day && minute_of_day < to : minute_of_day >= from || minute_of_day < to;
  }
};

enum class MailSecurity { kStartTls, kTls, kNone };

struct MailSettings {
  std::string server;  ///< HOST:PORT.
  MailSecurity security = MailSecurity::kStartTls;
  std::string user{};
  std::filesystem::path password_file{};
  std::string from{};
  std::vector<std::string> to{};
  std::filesystem::path authority{};  ///< Certificates that the server's is checked with; empty: this computer's.
};

struct WebhookSettings {
  std::string url;
  std::filesystem::path token_file{};
  std::filesystem::path authority{};
};

struct AlarmSettings {
  std::chrono::seconds after{120};
  std::optional<QuietHours> quiet{};
  bool has_warnings = false;  ///< Warnings are reported as well as faults.
  std::optional<MailSettings> mail{};
  std::optional<WebhookSettings> webhook{};

  [[nodiscard]] bool has_receiver() const { return mail.has_value() || webhook.has_value(); }
};

struct CareSettings {
  std::string language;  ///< "de"; empty: each reader's own.
  AlarmSettings alarms;
  std::filesystem::path metrics_token_file;  ///< Empty: the page's metrics need its PIN.
};

/// Reads care.toml; a file that is missing gives the defaults. Files that it names are in its folder. Errors: kBadData
/// with file, line and remedy.
Result<CareSettings> read_care_settings(const std::filesystem::path& file);

/// Reads a text; `name` stands for the file. Files that it names are relative.
Result<CareSettings> parse_care_settings(std::string_view text, const std::string& name);

/// Returns the first line of a secret's file. Errors: those of read_text_file(); kBadData if it is empty or has
/// characters that no header may contain.
Result<std::string> read_secret(const std::filesystem::path& file);

}  // namespace cyclorama::care
