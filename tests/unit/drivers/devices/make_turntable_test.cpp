// SPDX-License-Identifier: Apache-2.0
#include "drivers/devices/make_turntable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/doubles/scripted_controller.h"

namespace cyclorama::devices {
namespace {

TEST(MakeTurntable, reports_what_is_wrong_with_a_line_of_text) {
  const auto code = [](std::string_view spec) { return make_turntable(spec, nullptr).error().code(); };
  EXPECT_EQ(code("lazy-susan"), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("serial:"), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("serial:/dev/null?speed=3"), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("serial:/dev/null?axis=XY"), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("serial:/dev/null?baud=nan"), ErrorCode::kInvalidArgument);
  EXPECT_THAT(make_turntable("serial:/dev/null?least_deg=-90", nullptr).error().message(),  // A renamed option.
              testing::HasSubstr("is now called 'min_deg'"));
  EXPECT_EQ(code("serial:/dev/there-is-none?baud=9600&axis=A"), ErrorCode::kNotFound);
  EXPECT_TRUE(make_turntable("manual", nullptr));
  ScriptedController controller;
  auto turntable =
      make_turntable("serial:" + controller.device() + "?units_per_turn=1600&min_deg=-90&max_deg=45", nullptr);
  ASSERT_TRUE(turntable);
  EXPECT_NEAR((*turntable)->range().max_rad, 0.785398, 1e-6);
}

}  // namespace
}  // namespace cyclorama::devices
