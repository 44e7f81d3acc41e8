// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/alarm_message.h"

#include <absl/strings/escaping.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace cyclorama::care {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<Alarm> kAlarms{
    {{"heads", "Projectors", "No picture goes to 'left'.", "See the entry of each projector."},
     WallSeconds(1'795'596'720s),
     WallSeconds(1'795'596'840s),
     false},
    {{"disk", "Disk", "3.0 GB of 64.0 GB are free.", ""},
     WallSeconds(1'795'590'000s),
     WallSeconds(1'795'596'840s),
     true}};

MailSettings mail() {
  MailSettings settings;
  settings.from = "wall@example.org";
  settings.to = {"a@example.org", "b@example.org"};
  return settings;
}

std::string body_of(const std::string& message) {
  std::string code;
  for (const char c : message.substr(message.find("\r\n\r\n") + 4)) {
    if (c != '\r' && c != '\n') code += c;
  }
  std::string body;
  EXPECT_TRUE(absl::Base64Unescape(code, &body));
  return body;
}

TEST(MailText, is_a_message_in_the_museums_language) {
  const AlarmSender sender{"Höhle 3", "https://192.0.2.7:8443/", Catalogue::of("de")};
  const std::string message = mail_text(kAlarms, sender, mail(), "id-1");
  EXPECT_THAT(message, HasSubstr("Date: Wed, 25 Nov 2026 08:54:00 +0000\r\n"));
  EXPECT_THAT(message, HasSubstr("<wall@example.org>\r\nTo: a@example.org,\r\n b@example.org\r\n"));
  EXPECT_THAT(message, HasSubstr("Message-ID: <id-1@example.org>\r\n"));
  EXPECT_THAT(message, HasSubstr("Auto-Submitted: auto-generated\r\n"));
  const std::string body = body_of(message);
  EXPECT_THAT(body, HasSubstr("Höhle 3\n"));
  EXPECT_THAT(body, HasSubstr("Kein Bild geht an 'left'."));
  EXPECT_THAT(body, HasSubstr("Siehe den Eintrag jedes Projektors."));
  EXPECT_THAT(body, HasSubstr("Datenträger"));
  EXPECT_THAT(body, Not(HasSubstr("3,0 GB"))) << "what is over needs no words";
  EXPECT_THAT(body, HasSubstr("2026-11-25T08:52:00Z"));
  EXPECT_THAT(body, HasSubstr("https://192.0.2.7:8443/"));
}

TEST(MailText, lets_no_name_add_a_header_and_has_no_long_line) {
  const std::string name = "Museum\r\nBcc: thief@example.org\r\n\r\n" + std::string(500, 'x');
  const AlarmSender sender{name, "", Catalogue::of("zh")};
  const std::string message = mail_text(kAlarms, sender, mail(), "id-1");
  EXPECT_THAT(message, Not(HasSubstr("\nBcc")));
  std::size_t begin = 0;
  for (std::size_t end = message.find("\r\n"); end != std::string::npos; end = message.find("\r\n", begin)) {
    EXPECT_LE(end - begin, 98U);
    for (const char c : message.substr(begin, end - begin)) EXPECT_TRUE(c >= ' ' && c < 127);
    begin = end + 2;
  }
  EXPECT_EQ(begin, message.size());
}

TEST(WebhookJson, has_both_states_and_all_texts) {
  const AlarmSender sender{"hall-3", "", Catalogue::of("en")};
  const auto json = nlohmann::json::parse(webhook_json(kAlarms, sender));
  EXPECT_EQ(json["museum"], "hall-3");
  ASSERT_EQ(json["alarms"].size(), 2U);
  EXPECT_EQ(json["alarms"][0]["state"], "begun");
  EXPECT_EQ(json["alarms"][0]["sentence"], "No picture goes to 'left'.");
  EXPECT_EQ(json["alarms"][0]["since"], "2026-11-25T08:52:00Z");
  EXPECT_EQ(json["alarms"][1]["state"], "over");
  EXPECT_EQ(json["alarms"][1]["id"], "disk");
}

}  // namespace
}  // namespace cyclorama::care
