// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/alarm_message.h"

#include <absl/strings/escaping.h>
#include <absl/time/time.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "common/language/marked_texts.h"

namespace cyclorama::care {
namespace {

constexpr std::size_t kBodyLine = 76;     // RFC 2045, 6.8.
constexpr std::size_t kHeaderBytes = 30;  // With base64 and its frame, below the 75 characters of RFC 2047.
constexpr std::size_t kMaxName = 100;

std::string base64(std::string_view text) { return absl::Base64Escape({text.data(), text.size()}); }

std::string base64_lines(std::string_view text) {
  const std::string code = base64(text);
  std::string lines;
  for (std::size_t at = 0; at < code.size(); at += kBodyLine) lines += code.substr(at, kBodyLine) + "\r\n";
  return lines;
}

/// Returns text as encoded words (RFC 2047), each with whole characters.
std::string header_text(std::string_view text) {
  std::string words;
  while (!text.empty()) {
    std::size_t size = std::min(kHeaderBytes, text.size());
    while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) --size;
    if (size == 0) size = std::min(kHeaderBytes, text.size());
    words += (words.empty() ? "=?UTF-8?B?" : "\r\n =?UTF-8?B?") + base64(text.substr(0, size)) + "?=";
    text.remove_prefix(size);
  }
  return words;
}

std::string time_text(WallSeconds time) {
  return absl::FormatTime("%E4Y-%m-%dT%H:%M:%SZ", absl::FromChrono(time), absl::UTCTimeZone());
}

std::string subject_of(std::span<const Alarm> alarms, const AlarmSender& sender, const std::string& museum) {
  const Alarm& first = alarms.front();
  const std::string what = fmt::format(
      fmt::runtime(first.is_over ? translatable("Over: {}") : translatable("Fault: {}")), first.fault.title);
  const std::string text = sender.language.sentence(what);
  const std::string more = alarms.size() > 1 ? fmt::format(" (+{})", alarms.size() - 1) : "";
  return fmt::format("{}: {}{}", museum, text, more);
}

std::string body_of(std::span<const Alarm> alarms, const AlarmSender& sender, const std::string& museum) {
  const Catalogue& language = sender.language;
  std::string body = museum + "\n\n";
  for (const Alarm& alarm : alarms) {
    const Fault& fault = alarm.fault;
    body += language.sentence(fmt::format(
                fmt::runtime(alarm.is_over ? translatable("Over: {}") : translatable("Fault: {}")), fault.title)) +
            "\n";
    if (!alarm.is_over) body += language.sentence(fault.sentence) + "\n";
    if (!alarm.is_over && !fault.remedy.empty()) body += language.sentence(fault.remedy) + "\n";
    body += language.sentence(fmt::format(translatable("Since {}."), time_text(alarm.since))) + "\n\n";
  }
  if (!sender.page.empty())
    body += language.sentence(fmt::format(translatable("The operator's page: {}"), sender.page)) + "\n";
  return body;
}

}  // namespace

std::string mail_text(std::span<const Alarm> alarms, const AlarmSender& sender, const MailSettings& mail,
                      const std::string& id) {
  const std::string museum = printable(sender.museum, kMaxName);
  const absl::Time now = absl::FromChrono(alarms.front().at);
  std::string to;
  for (const std::string& one : mail.to) to += (to.empty() ? "" : ",\r\n ") + one;
  return fmt::format(
             "Date: {}\r\nFrom: {} <{}>\r\nTo: {}\r\nSubject: {}\r\nMessage-ID: <{}@{}>\r\n"
             "Auto-Submitted: auto-generated\r\nMIME-Version: 1.0\r\nContent-Type: text/plain; charset=UTF-8\r\n"
             "Content-Language: {}\r\nContent-Transfer-Encoding: base64\r\n\r\n",
             absl::FormatTime("%a, %d %b %E4Y %H:%M:%S +0000", now, absl::UTCTimeZone()), header_text(museum),
             mail.from, to, header_text(subject_of(alarms, sender, museum)), id,
             mail.from.substr(mail.from.find('@') + 1), sender.language.language()) +
         base64_lines(body_of(alarms, sender, museum));
}

std::string webhook_json(std::span<const Alarm> alarms, const AlarmSender& sender) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Alarm& alarm : alarms) {
    list.push_back({{"id", alarm.fault.id},
                    {"state", alarm.is_over ? "over" : "begun"},
                    {"title", sender.language.sentence(alarm.fault.title)},
                    {"sentence", sender.language.sentence(alarm.fault.sentence)},
                    {"remedy", sender.language.sentence(alarm.fault.remedy)},
                    {"since", time_text(alarm.since)},
                    {"at", time_text(alarm.at)}});
  }
  return nlohmann::ordered_json{{"museum", sender.museum}, {"page", sender.page}, {"alarms", std::move(list)}}.dump(
      1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace cyclorama::care
