// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/features/instruction_counter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::render {
namespace {

TEST(InstructionCounter, counts_upwards_or_reports_that_it_is_unavailable) {
  const auto counter = InstructionCounter::open();
  if (!counter) {
    EXPECT_TRUE(counter.error().message().starts_with("counting instructions: "));
    return;
  }
  const auto before = counter->count();
  volatile int sum = 0;
  constexpr int kMinInstructions = 10000;
  for (int i = 0; i < kMinInstructions; ++i) sum = sum + i;
  const auto after = counter->count();
  ASSERT_TRUE(before.has_value() && after.has_value());
  EXPECT_GE(*after - *before, static_cast<std::uint64_t>(kMinInstructions));
}

}  // namespace
}  // namespace cyclorama::render
