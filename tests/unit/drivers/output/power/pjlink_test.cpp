// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/power/pjlink.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/doubles/fake_projector.h"

namespace cyclorama::output {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr auto kTimeout = std::chrono::seconds(20);

PjlinkProjector at(const FakeProjector& fake, std::string password = {}) {
  return {{"::1", fake.port()}, std::move(password)};
}

TEST(Pjlink, switches_on_and_off) {
  const FakeProjector fake("PJLINK 0\r", [](const std::string&) { return "%1POWR=OK\r"; });
  EXPECT_TRUE(set_power(at(fake), true, kTimeout));
  EXPECT_TRUE(set_power(at(fake), false, kTimeout));
  EXPECT_THAT(fake.heard(), ElementsAre("%1POWR 1", "%1POWR 0"));
}

TEST(Pjlink, requests_the_state) {
  for (const auto& [digit, power] :
       {std::pair("0", ProjectorPower::kOff), std::pair("1", ProjectorPower::kOn),
        std::pair("2", ProjectorPower::kCooling), std::pair("3", ProjectorPower::kWarming)}) {
    const std::string answer = std::string("%1POWR=") + digit + "\r";
    const FakeProjector fake("PJLINK 0\r", [&](const std::string&) { return answer; });
    const auto asked = query_power(at(fake), kTimeout);
    ASSERT_TRUE(asked) << asked.error().message();
    EXPECT_EQ(*asked, power);
    EXPECT_THAT(fake.heard(), ElementsAre("%1POWR ?"));
  }
}

// Example from section 5.2 of the specification: 498e4a67 and JBMIAProjectorLink.
TEST(Pjlink, authenticates_with_the_password) {
  const FakeProjector fake("PJLINK 1 498e4a67\r", [](const std::string& line) {
    return line.starts_with("5d8409bc1c3fa39749434aa3a5c38682%1POWR") ? "%1POWR=1\r" : "PJLINK ERRA\r";
  });
  EXPECT_TRUE(query_power(at(fake, "JBMIAProjectorLink"), kTimeout));
  const auto wrong = query_power(at(fake, "wrong"), kTimeout);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(wrong.error().message(), HasSubstr("refuses the password"));
  EXPECT_THAT(query_power(at(fake), kTimeout).error().message(), HasSubstr("wants a password"));
}

TEST(Pjlink, reports_what_a_projector_refuses) {
  const auto code = [](const char* line) { return pjlink::parse_power(line).error().code(); };
  EXPECT_EQ(code("%1POWR=ERR1"), ErrorCode::kBadData);
  EXPECT_EQ(code("%1POWR=ERR3"), ErrorCode::kUnavailable);
  EXPECT_EQ(code("%1POWR=ERR4"), ErrorCode::kSystem);
  EXPECT_EQ(code("PJLINK ERRA"), ErrorCode::kInvalidArgument);
  for (const char* wrong : {"", "%1POWR=", "%1POWR=4", "%1POWR=11", "%2POWR=1", "HTTP/1.1 400 Bad Request"})
    EXPECT_EQ(code(wrong), ErrorCode::kBadData) << wrong;
  EXPECT_EQ(pjlink::parse_answer("%1POWR=" + std::string(1000, 'x')).error().code(), ErrorCode::kBadData);
}

TEST(Pjlink, detects_peers_of_another_protocol) {
  for (const char* wrong : {"", "PJLINK", "PJLINK 2", "PJLINK 1 ", "PJLINK 1 498e4a6", "PJLINK 1 498e4a6g", "SSH-2.0"})
    EXPECT_EQ(pjlink::authorise(wrong, "x").error().code(), ErrorCode::kBadData) << wrong;
  const FakeProjector endless(std::string(1000, 'x'), [](const std::string&) { return ""; });
  EXPECT_EQ(query_power(at(endless), kTimeout).error().code(), ErrorCode::kBadData);
}

TEST(Pjlink, times_out_on_a_silent_or_missing_projector) {
  const FakeProjector silent("", [](const std::string&) { return ""; });
  const auto asked = query_power(at(silent), milliseconds(30));
  ASSERT_FALSE(asked);
  EXPECT_EQ(asked.error().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(asked.error().message(), HasSubstr("projector at ::1:"));
  const FakeProjector hangs_up("PJLINK 0\r", [](const std::string&) { return ""; });
  EXPECT_EQ(query_power(at(hangs_up), kTimeout).error().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(query_power({{"::1", 1}, ""}, kTimeout).error().code(), ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace cyclorama::output
