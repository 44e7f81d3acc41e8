// SPDX-License-Identifier: Apache-2.0
#include "common/process/child.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using namespace std::chrono_literals;

TEST(Child, gives_what_a_program_said_and_how_it_ended) {
  const auto end = run_child({"sh", "-c", "echo out; echo err >&2; exit 3"});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 3);
  EXPECT_EQ(end->output, "out\nerr\n");
  EXPECT_FALSE(end->is_cut);
}

TEST(Child, passes_words_on_as_they_are) {
  const auto end = run_child({"printf", "%s|", "a b", "$HOME", "'\"", ""});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->output, "a b|$HOME|'\"||");
}

TEST(Child, is_cut_short_when_it_says_too_much_but_runs_to_its_end) {
  const auto end = run_child({"sh", "-c", "yes | head -c 300000; exit 7"}, {10s, 1000});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->output.size(), 1000u);
  EXPECT_TRUE(end->is_cut);
  EXPECT_EQ(end->exit_code, 7);
}

TEST(Child, is_killed_at_its_limit_with_all_that_it_started) {
  for (const char* const script : {"sleep 100", "sleep 100 & sleep 100", "exec >&- 2>&-; sleep 100"}) {
    const auto end = run_child({"sh", "-c", script}, {200ms, 1000});
    ASSERT_FALSE(end) << script;
    EXPECT_EQ(end.error().code(), ErrorCode::kTimedOut);
  }
}

TEST(Child, tells_the_signal_that_ended_it) {
  const auto end = run_child({"sh", "-c", "kill -9 $$"});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 128 + 9);
}

TEST(Child, is_not_found_where_there_is_no_such_program) {
  const auto end = run_child({"/nowhere/at-all"});
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama
