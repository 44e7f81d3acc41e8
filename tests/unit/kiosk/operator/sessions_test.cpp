// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/file.h"
#include "common/http/peer_network.h"
#include "kiosk/provision/pin.h"
#include "tests/doubles/fake_clock.h"

namespace cyclorama::operations {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* kHere = "192.0.2.7";

struct LoginFixture {
  FakeClock clock;
  std::filesystem::path folder;
  std::unique_ptr<Sessions> sessions;

  explicit LoginFixture(SessionRules rules = {}) {
    std::string name = (std::filesystem::temp_directory_path() / "door-XXXXXX").string();
    CHECK(::mkdtemp(name.data()) != nullptr);
    folder = name;
    set_pin("401773");
    sessions = std::make_unique<Sessions>(clock, folder / "pin", rules);
  }
  ~LoginFixture() { std::filesystem::remove_all(folder); }
  LoginFixture(const LoginFixture&) = delete;
  LoginFixture& operator=(const LoginFixture&) = delete;
  void set_pin(const char* pin) const {
    const auto hash = provision::hashed_pin(pin);
    CHECK(hash);
    CHECK(write_file_atomically(folder / "pin", std::string_view(*hash)));
  }
  [[nodiscard]] ErrorCode refused(const std::string& pin, const std::string& from = kHere,
                                  const std::string& device = "") const {
    const auto token = sessions->open(pin, from, {.device = device});
    return token ? ErrorCode::kSystem : token.error().code();
  }
};

TEST(Sessions, admit_a_client_that_knows_the_pin_for_a_limited_time) {
  LoginFixture door;
  const auto token = door.sessions->open("40 17 73", kHere);
  ASSERT_TRUE(token);
  EXPECT_EQ(token->session.size(), 64u);
  EXPECT_TRUE(door.sessions->is_open(token->session));
  EXPECT_FALSE(door.sessions->is_open(""));
  EXPECT_FALSE(door.sessions->is_open(token->device));
  EXPECT_FALSE(door.sessions->is_open(token->session.substr(1)));
  const auto other = door.sessions->open("401773", kHere);
  ASSERT_TRUE(other);
  EXPECT_NE(other->session, token->session);
  EXPECT_NE(other->device, token->device);
  door.sessions->close(token->session);
  EXPECT_FALSE(door.sessions->is_open(token->session));
  EXPECT_TRUE(door.sessions->is_open(other->session));
}

TEST(Sessions, end_after_half_an_hour_without_requests_or_half_a_day) {
  LoginFixture door;
  const auto idle = door.sessions->open("401773", kHere);
  ASSERT_TRUE(idle);
  door.clock.advance(31min);
  EXPECT_FALSE(door.sessions->is_open(idle->session));
  const auto busy = door.sessions->open("401773", kHere);
  ASSERT_TRUE(busy);
  for (int i = 0; i < 35; ++i) {
    door.clock.advance(20min);
    EXPECT_TRUE(door.sessions->is_open(busy->session)) << i;
  }
  door.clock.advance(25min);
  EXPECT_FALSE(door.sessions->is_open(busy->session));
}

TEST(Sessions, delay_guesses_more_and_more_even_with_the_right_pin) {
  LoginFixture door;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(door.refused("000001"), ErrorCode::kInvalidArgument);
  EXPECT_EQ(door.refused("401773"), ErrorCode::kBusy) << "within the wait no PIN is looked at";
  EXPECT_EQ(door.refused("401773", "2001:db8::1"), ErrorCode::kSystem) << "others come in";
  Duration wait = 2s;
  for (int i = 0; i < 4; ++i) {
    door.clock.advance(wait - 1ms);
    EXPECT_EQ(door.refused("000002"), ErrorCode::kBusy) << i;
    door.clock.advance(1ms);
    EXPECT_EQ(door.refused("000002"), ErrorCode::kInvalidArgument) << i;
    wait *= 2;
  }
  door.clock.advance(wait);
  EXPECT_TRUE(door.sessions->open("401773", kHere)) << "the right one at last";
  EXPECT_EQ(door.refused("000003"), ErrorCode::kInvalidArgument);
  EXPECT_EQ(door.refused("000003"), ErrorCode::kInvalidArgument) << "and the count begins anew";
}

TEST(Sessions, treat_all_addresses_of_one_network_as_one) {
  LoginFixture door;
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(door.refused("000001", "2001:db8:0:7::" + std::to_string(i)), ErrorCode::kInvalidArgument);
  }
  EXPECT_EQ(door.refused("401773", "2001:db8:0:7::abcd"), ErrorCode::kBusy);
  EXPECT_EQ(peer_network("2001:db8:0:7:1:2:3:4"), "2001:db8:0:7");
  EXPECT_EQ(peer_network("::ffff:192.0.2.7"), kHere);
  EXPECT_EQ(peer_network(kHere), kHere);
}

TEST(Sessions, limit_the_guesses_of_all_unknown_devices_together) {
  SessionRules rules;
  rules.tries_at_once = 5.0;
  LoginFixture door(rules);
  int looked_at = 0;
  for (int i = 0; i < 20; ++i) {
    looked_at += door.refused("000001", "192.0.2." + std::to_string(i)) == ErrorCode::kInvalidArgument ? 1 : 0;
  }
  EXPECT_LE(looked_at, 6);
  EXPECT_GE(looked_at, 5);
  door.clock.advance(3min);
  EXPECT_TRUE(door.sessions->open("401773", "198.51.100.1"));
}

TEST(Sessions, let_in_a_known_device_however_many_wrong_pins_others_try) {
  LoginFixture door;
  const auto before = door.sessions->open("401773", kHere);
  ASSERT_TRUE(before);
  for (int i = 0; i < 100; ++i) {
    const ErrorCode refused = door.refused("000001", "192.0.2." + std::to_string(i));
    EXPECT_TRUE(refused == ErrorCode::kInvalidArgument || refused == ErrorCode::kBusy);
  }
  EXPECT_EQ(door.refused("401773", "198.51.100.1"), ErrorCode::kBusy) << "unknown devices wait";
  const auto again = door.sessions->open("401773", kHere, {.device = before->device});
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(again->device, before->device);
  EXPECT_TRUE(door.sessions->is_open(again->session));
  // After a restart the device is still known.
  door.sessions = std::make_unique<Sessions>(door.clock, door.folder / "pin");
  for (int i = 0; i < 100; ++i) static_cast<void>(door.refused("000001", "192.0.2." + std::to_string(i)));
  EXPECT_TRUE(door.sessions->open("401773", kHere, {.device = before->device}));
}

TEST(Sessions, let_in_who_stands_before_the_wall_however_many_wrong_pins_others_try) {
  LoginFixture door;
  const auto code = door.sessions->renew_wall_code();
  ASSERT_TRUE(code);
  for (int i = 0; i < 100; ++i) static_cast<void>(door.refused("000001", "192.0.2." + std::to_string(i)));
  EXPECT_EQ(door.refused("401773"), ErrorCode::kBusy);
  const auto login = door.sessions->open("401773", kHere, {.wall_code = *code});
  ASSERT_TRUE(login) << login.error().message();
  EXPECT_TRUE(door.sessions->open("401773", kHere, {.device = login->device})) << "the device is known from now on";
  EXPECT_NE(*door.sessions->renew_wall_code(), *code);
  EXPECT_TRUE(door.sessions->open("401773", kHere, {.wall_code = *code})) << "it has just been scanned";
  ASSERT_TRUE(door.sessions->renew_wall_code());
  const auto old = door.sessions->open("401773", kHere, {.wall_code = *code});
  ASSERT_FALSE(old);
  EXPECT_EQ(old.error().code(), ErrorCode::kBusy);
  EXPECT_THAT(old.error().message(), HasSubstr("press Help at the wall"));
}

TEST(Sessions, delay_the_guesses_of_those_before_the_wall_too) {
  LoginFixture door;
  const auto code = door.sessions->renew_wall_code();
  for (int i = 0; i < 3; ++i) {
    const auto wrong = door.sessions->open("000001", kHere, {.wall_code = *code});
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().code(), ErrorCode::kInvalidArgument);
  }
  ASSERT_TRUE(door.sessions->renew_wall_code());
  const auto waits = door.sessions->open("401773", "198.51.100.1", {.wall_code = *code});
  ASSERT_FALSE(waits) << "from any network, and with any code";
  EXPECT_EQ(waits.error().code(), ErrorCode::kBusy);
}

TEST(Sessions, delay_the_guesses_of_a_known_device_too) {
  LoginFixture door;
  const std::string device = door.sessions->open("401773", kHere)->device;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(door.refused("000001", kHere, device), ErrorCode::kInvalidArgument);
  EXPECT_EQ(door.refused("401773", "198.51.100.1", device), ErrorCode::kBusy) << "from any network";
  EXPECT_TRUE(door.sessions->open("401773", kHere)) << "others are not affected";
  door.clock.advance(2s);
  EXPECT_TRUE(door.sessions->open("401773", kHere, {.device = device}));
}

TEST(Sessions, know_no_device_by_a_text_that_they_did_not_issue_for_this_pin) {
  SessionRules rules;
  rules.tries_at_once = 1.0;
  LoginFixture door(rules);
  std::string device = door.sessions->open("401773", kHere)->device;
  static_cast<void>(door.refused("000001", "192.0.2.1"));
  static_cast<void>(door.refused("000001", "192.0.2.2"));
  std::string changed = device;
  changed.back() = changed.back() == '0' ? '1' : '0';
  for (const std::string& text : {std::string(), std::string("."), changed, device + "0", device.substr(1)}) {
    EXPECT_EQ(door.refused("401773", kHere, text), ErrorCode::kBusy) << text;
  }
  door.set_pin("401773");
  EXPECT_EQ(door.refused("401773", kHere, device), ErrorCode::kBusy) << "the PIN was set anew";
}

TEST(Sessions, require_the_new_pin_as_soon_as_it_is_provisioned) {
  LoginFixture door;
  door.set_pin("771340");
  EXPECT_EQ(door.refused("401773"), ErrorCode::kInvalidArgument);
  EXPECT_TRUE(door.sessions->open("771340", kHere));
  std::filesystem::remove(door.folder / "pin");
  const auto none = door.sessions->open("771340", kHere);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(none.error().message(), HasSubstr("operator.toml"));
  EXPECT_TRUE(write_file_atomically(door.folder / "pin", std::string_view("junk")));
  EXPECT_EQ(door.refused("771340"), ErrorCode::kBadData);
}

TEST(Sessions, end_when_the_pin_changes_or_goes) {
  LoginFixture door;
  const auto login = door.sessions->open("401773", kHere);
  ASSERT_TRUE(login);
  door.set_pin("501773");
  EXPECT_FALSE(door.sessions->is_open(login->session));
  const auto again = door.sessions->open("501773", kHere);
  ASSERT_TRUE(again);
  EXPECT_TRUE(door.sessions->is_open(again->session));
  std::filesystem::remove(door.folder / "pin");
  EXPECT_FALSE(door.sessions->is_open(again->session));
}

TEST(Sessions, know_the_two_newest_codes_of_the_wall) {
  LoginFixture door;
  EXPECT_FALSE(door.sessions->is_wall_code(""));
  const std::string first = *door.sessions->renew_wall_code();
  const std::string second = *door.sessions->renew_wall_code();
  EXPECT_TRUE(door.sessions->is_wall_code(first));
  EXPECT_TRUE(door.sessions->is_wall_code(second));
  EXPECT_FALSE(door.sessions->is_wall_code(second.substr(1)));
  ASSERT_TRUE(door.sessions->renew_wall_code());
  EXPECT_FALSE(door.sessions->is_wall_code(first));
}

TEST(Sessions, are_limited_in_number) {
  SessionRules rules;
  rules.max = 2;
  LoginFixture door(rules);
  const auto first = door.sessions->open("401773", kHere);
  door.clock.advance(1s);
  const auto second = door.sessions->open("401773", kHere);
  door.clock.advance(1s);
  ASSERT_TRUE(first && second && door.sessions->is_open(first->session));
  door.clock.advance(1s);
  ASSERT_TRUE(door.sessions->open("401773", kHere));
  EXPECT_TRUE(door.sessions->is_open(first->session)) << "used last";
  EXPECT_FALSE(door.sessions->is_open(second->session));
}

}  // namespace
}  // namespace cyclorama::operations
