// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/care_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "common/base/address.h"
#include "common/base/file.h"
#include "common/config/config.h"
#include "common/language/catalogue.h"
#include "common/opening/opening_hours.h"

namespace cyclorama::care {
namespace {

constexpr std::size_t kMaxReceivers = 20;
constexpr std::size_t kMaxAddress = 254;  // RFC 5321, 4.5.3.1.
constexpr std::size_t kMaxUrl = 2000;
constexpr std::size_t kMaxSecretBytes = 1024;

bool is_plain(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c > ' ' && c < 127; });
}

/// True for an address that can stand in SMTP's commands and in a message's header as it is.
bool is_mail_address(std::string_view text) {
  const std::size_t at = text.find('@');
  return at != std::string_view::npos && at > 0 && at + 1 < text.size() && text.size() <= kMaxAddress &&
         is_plain(text) && text.find_first_of("<>()[],;:\\\"") == std::string_view::npos &&
         text.find('@', at + 1) == std::string_view::npos;
}

std::optional<QuietHours> parse_quiet(std::string_view text) {
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto from = time_of_day(text.substr(0, dash));
  const auto to = time_of_day(text.substr(dash + 1));
  if (!from || !to || *from == *to) return std::nullopt;
  return QuietHours{*from, *to};
}

/// Returns the host of "https://HOST[:PORT]/…"; empty for another text.
std::string host_of(std::string_view url, std::string_view scheme) {
  if (!url.starts_with(scheme)) return "";
  url.remove_prefix(scheme.size());
  return std::string(url.substr(0, url.find_first_of("/?#")));
}

class Reader {
 public:
  explicit Reader(std::filesystem::path folder) : folder_(std::move(folder)) {}

  AlarmSettings alarms(ConfigTable table) {
    AlarmSettings settings;
    settings.after = std::chrono::seconds(table.integer("after_s", {10, 86400}, 120));
    settings.has_warnings = table.choice("level", {"fault", "warning"}, "fault") == "warning";
    if (table.has("quiet")) {
      settings.quiet = parse_quiet(table.text("quiet"));
      if (!settings.quiet) table.refuse("quiet", "must be two different times such as \"22:00-07:00\"");
    }
    if (table.has("mail")) settings.mail = mail(table.table("mail"));
    if (table.has("webhook")) settings.webhook = webhook(table.table("webhook"));
    return settings;
  }
  std::filesystem::path file(ConfigTable& table, const char* key) {
    const std::string name = table.text(key, "");
    return name.empty() ? std::filesystem::path() : folder_ / name;
  }

 private:
  MailSettings mail(ConfigTable table) {
    MailSettings settings;
    settings.server = table.text("server");
    if (const auto address = parse_address(settings.server); !address)
      table.refuse("server", "must be HOST:PORT such as \"smtp.example.org:587\": " + address.error().message());
    const std::string security = table.choice("security", {"starttls", "tls", "none"}, "starttls");
    settings.security = security == "tls"    ? MailSecurity::kTls
                        : security == "none" ? MailSecurity::kNone
                                             : MailSecurity::kStartTls;
    if (settings.security == MailSecurity::kNone && !is_loopback(settings.server))
      table.refuse("security", "may be \"none\" only for a server on this computer; write \"starttls\" or \"tls\"");
    settings.user = table.text("user", "");
    if (!is_plain(settings.user)) table.refuse("user", "must be one word without spaces");
    settings.password_file = file(table, "password_file");
    if (settings.user.empty() != settings.password_file.empty())
      table.refuse("user", "and 'password_file' belong together; write both, or neither");
    settings.authority = file(table, "authority");
    settings.from = table.text("from");
    if (!is_mail_address(settings.from)) table.refuse("from", "must be a mail address such as \"wall@example.org\"");
    settings.to = table.texts("to");
    if (settings.to.empty() || settings.to.size() > kMaxReceivers)
      table.refuse("to", fmt::format("must be a list of 1 to {} mail addresses", kMaxReceivers));
    for (const std::string& one : settings.to) {
      if (!is_mail_address(one)) table.refuse("to", "must be mail addresses such as \"technician@example.org\"");
    }
    return settings;
  }

  WebhookSettings webhook(ConfigTable table) {
    WebhookSettings settings;
    settings.url = table.text("url");
    const std::string host = host_of(settings.url, "http://");
    const bool is_plain_http = !host.empty();
    if ((!is_plain_http && host_of(settings.url, "https://").empty()) || !is_plain(settings.url) ||
        settings.url.size() > kMaxUrl || settings.url.find('@') != std::string::npos)
      table.refuse("url", "must be an address such as \"https://alarms.example.org/cyclorama\"");
    if (is_plain_http && !is_loopback(host.find_last_of(':') == std::string::npos ? host + ":80" : host))
      table.refuse("url",
                   "must begin with https://, since alarms tell much about a house; http:// is for this computer");
    settings.token_file = file(table, "token_file");
    settings.authority = file(table, "authority");
    return settings;
  }

  std::filesystem::path folder_;
};

Result<CareSettings> settings_of(Config config, const std::filesystem::path& folder) {
  CareSettings settings;
  ConfigTable root = config.root();
  Reader reader(folder);
  if (root.has("language")) {
    std::vector<std::string> languages;
    for (const Catalogue& one : Catalogue::all()) languages.push_back(one.language());
    settings.language = root.choice("language", languages);
  }
  if (root.has("alarms")) settings.alarms = reader.alarms(root.table("alarms"));
  if (root.has("metrics")) {
    ConfigTable metrics = root.table("metrics");
    settings.metrics_token_file = reader.file(metrics, "token_file");
  }
  TRY(config.finish());
  return settings;
}

}  // namespace

Result<CareSettings> read_care_settings(const std::filesystem::path& file) {
  std::error_code missing;
  if (!std::filesystem::exists(file, missing)) return CareSettings();
  TRY_ASSIGN(Config config, Config::read(file));
  return settings_of(std::move(config), file.parent_path());
}

Result<CareSettings> parse_care_settings(std::string_view text, const std::string& name) {
  TRY_ASSIGN(Config config, Config::parse(text, name));
  return settings_of(std::move(config), {});
}

Result<std::string> read_secret(const std::filesystem::path& file) {
  TRY_ASSIGN(std::string text, read_text_file(file, kMaxSecretBytes));
  text.resize(std::min(text.find_first_of("\r\n"), text.size()));
  const bool is_good = !text.empty() && std::ranges::all_of(text, [](char c) {
    return static_cast<unsigned char>(c) >= ' ' && c != 127;
  });
  if (is_good) return text;
  return Error(ErrorCode::kBadData,
               fmt::format("'{}' must have the secret in its first line, and nothing else", file.filename().string()));
}

}  // namespace cyclorama::care
