// SPDX-License-Identifier: Apache-2.0
#include "common/process/child.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using namespace std::chrono_literals;

TEST(Child, returns_a_programs_output_and_exit_code) {
  const auto end = run_child({"sh", "-c", "echo out; echo err >&2; exit 3"});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 3);
  EXPECT_EQ(end->output, "out\nerr\n");
  EXPECT_FALSE(end->is_cut);
}

TEST(Child, passes_arguments_unchanged) {
  const auto end = run_child({"printf", "%s|", "a b", "$HOME", "'\"", ""});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->output, "a b|$HOME|'\"||");
}

TEST(Child, truncates_long_output_but_lets_the_program_finish) {
  const auto end = run_child({"sh", "-c", "yes | head -c 300000; exit 7"}, {10s, 1000});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->output.size(), 1000u);
  EXPECT_TRUE(end->is_cut);
  EXPECT_EQ(end->exit_code, 7);
}

TEST(Child, is_killed_at_its_timeout_with_all_its_descendants) {
  for (const char* const script : {"sleep 100", "sleep 100 & sleep 100", "exec >&- 2>&-; sleep 100"}) {
    const auto end = run_child({"sh", "-c", script}, {200ms, 1000});
    ASSERT_FALSE(end) << script;
    EXPECT_EQ(end.error().code(), ErrorCode::kTimedOut);
  }
}

TEST(Child, reports_the_signal_that_ended_it) {
  const auto end = run_child({"sh", "-c", "kill -9 $$"});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 128 + 9);
}

TEST(Child, reports_a_missing_program) {
  const auto end = run_child({"/nowhere/at-all"});
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama
