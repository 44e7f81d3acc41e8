// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/alarm_outbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::care {
namespace {

using namespace std::chrono_literals;
using ::testing::IsEmpty;
using ::testing::SizeIs;

WallSeconds at(std::chrono::seconds time) { return WallSeconds(1'800'000'000s + time); }

Alarm alarm(const std::string& id) { return {{id, "Title", "Sentence.", "Remedy."}, at(0s), at(120s), false}; }

TEST(AlarmOutbox, tries_again_after_longer_and_longer_and_never_gives_up) {
  AlarmOutbox outbox;
  const std::vector<Alarm> one{alarm("disk")};
  outbox.add(AlarmChannel::kMail, one);
  std::chrono::seconds now{0};
  std::vector<long> waits;
  for (int i = 0; i < 9; ++i) {
    ASSERT_THAT(outbox.due(AlarmChannel::kMail, at(now)), SizeIs(1));
    outbox.failed(AlarmChannel::kMail, at(now));
    const auto failed = now;
    while (outbox.due(AlarmChannel::kMail, at(now)).empty()) now += 1s;
    waits.push_back((now - failed).count());
  }
  EXPECT_THAT(waits, ::testing::ElementsAre(60, 120, 240, 480, 960, 1920, 3600, 3600, 3600));
  outbox.sent(AlarmChannel::kMail, 1);
  EXPECT_THAT(outbox.due(AlarmChannel::kMail, at(now)), IsEmpty());
  outbox.add(AlarmChannel::kMail, one);
  EXPECT_THAT(outbox.due(AlarmChannel::kMail, at(now)), SizeIs(1)) << "a success ends the waiting";
}

TEST(AlarmOutbox, keeps_channels_apart_and_drops_the_oldest_beyond_the_limit) {
  AlarmOutbox outbox;
  for (int i = 0; i < 250; ++i) {
    const std::vector<Alarm> one{alarm(std::to_string(i))};
    outbox.add(AlarmChannel::kWebhook, one);
  }
  const auto waiting = outbox.due(AlarmChannel::kWebhook, at(0s));
  ASSERT_THAT(waiting, SizeIs(AlarmOutbox::kMaxWaiting));
  EXPECT_EQ(waiting.front().fault.id, "150");
  EXPECT_THAT(outbox.due(AlarmChannel::kMail, at(0s)), IsEmpty());
  outbox.sent(AlarmChannel::kWebhook, 99);
  EXPECT_THAT(outbox.due(AlarmChannel::kWebhook, at(0s)), SizeIs(1));
  outbox.clear(AlarmChannel::kWebhook);
  EXPECT_THAT(outbox.due(AlarmChannel::kWebhook, at(0s)), IsEmpty());
}

TEST(AlarmOutbox, survives_a_restart_and_refuses_a_damaged_state) {
  AlarmOutbox before;
  const std::vector<Alarm> two{alarm("disk"), {{"pin", "PIN", "", ""}, at(5s), at(9s), true}};
  before.add(AlarmChannel::kMail, two);
  AlarmOutbox after;
  ASSERT_TRUE(after.read_json(before.to_json(), "alarms-waiting.json"));
  EXPECT_EQ(after.due(AlarmChannel::kMail, at(0s)), two);
  for (const char* const bad :
       {"", "{}", R"({"version": 1, "mail": []})", R"({"version": 1, "mail": 3, "webhook": []})"}) {
    EXPECT_FALSE(after.read_json(bad, "alarms-waiting.json")) << bad;
    EXPECT_EQ(after.due(AlarmChannel::kMail, at(0s)), two);
  }
}

TEST(AlarmOutbox, does_not_wait_for_years_after_the_clock_was_set_back) {
  AlarmOutbox outbox;
  const std::vector<Alarm> one{alarm("disk")};
  outbox.add(AlarmChannel::kMail, one);
  outbox.failed(AlarmChannel::kMail, at(1'000'000s));
  EXPECT_THAT(outbox.due(AlarmChannel::kMail, at(0s)), SizeIs(1));
}

}  // namespace
}  // namespace cyclorama::care
