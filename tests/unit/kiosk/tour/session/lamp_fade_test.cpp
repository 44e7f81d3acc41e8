// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/lamp_fade.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LampFadeTest : public testing::Test {
 protected:
  LampFadeTest() {
    lamps_.open({"daylight", "butter lamps"});
    lamps_.step(now_);
  }
  void pass(Duration time) { lamps_.step(now_ += time); }

  TimePoint now_{1h};
  LampFade lamps_;
};

TEST_F(LampFadeTest, lamps_are_as_the_scene_describes_them_until_somebody_wants_them_otherwise) {
  pass(10s);
  EXPECT_THAT(lamps_.levels(), IsEmpty());
  EXPECT_FALSE(lamps_.is_moving());
}

TEST_F(LampFadeTest, a_group_goes_dark_within_two_seconds_and_others_stay) {
  ASSERT_TRUE(lamps_.want({{"daylight", 0.0f}}));
  EXPECT_TRUE(lamps_.is_moving());
  float last = 1.0f;
  for (int tick = 0; tick < 119; ++tick) {
    pass(Duration(1s) / 60);
    const std::vector<float> levels = lamps_.levels();
    ASSERT_EQ(levels.size(), 2u);
    EXPECT_LT(levels[0], last);
    EXPECT_GT(levels[0], last - 0.01f) << "no step is seen";
    EXPECT_EQ(levels[1], 1.0f);
    last = levels[0];
  }
  pass(1s);
  EXPECT_THAT(lamps_.levels(), ElementsAre(0.0f, 1.0f));
  EXPECT_FALSE(lamps_.is_moving());
  ASSERT_TRUE(lamps_.want({{"daylight", 1.0f}}));
  pass(1s);
  EXPECT_THAT(lamps_.levels(), ElementsAre(testing::FloatNear(0.5f, 1e-5f), 1.0f));
  pass(10h);
  EXPECT_THAT(lamps_.levels(), IsEmpty());
}

TEST_F(LampFadeTest, an_unknown_group_or_a_wrong_level_changes_nothing_and_names_the_remedy) {
  const auto refused = [&](const LampSettings& wanted) {
    const Status status = lamps_.want(wanted);
    return status ? std::string("accepted") : status.error().message();
  };
  EXPECT_THAT(refused({{"butter lamps", 0.5f}, {"torch", 1.0f}}), HasSubstr("it has daylight, butter lamps"));
  EXPECT_THAT(refused({{"daylight", 4.5f}}), HasSubstr("must be 0 to 4"));
  EXPECT_THAT(refused({{"daylight", -0.1f}}), HasSubstr("must be 0 to 4"));
  EXPECT_THAT(refused({{"daylight", std::nanf("")}}), HasSubstr("must be 0 to 4"));
  EXPECT_FALSE(lamps_.is_moving());
}

TEST_F(LampFadeTest, another_scene_begins_with_its_own_lamps) {
  ASSERT_TRUE(lamps_.want({{"daylight", 0.0f}}));
  pass(5s);
  lamps_.open({});
  EXPECT_THAT(lamps_.levels(), IsEmpty());
  EXPECT_THAT(lamps_.want({{"daylight", 0.0f}}).error().message(), HasSubstr("it has none"));
}

}  // namespace
}  // namespace cyclorama::tour
