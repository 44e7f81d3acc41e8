// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/probe_runner.h"

#include <gtest/gtest.h>

#include <future>

namespace cyclorama::output {
namespace {

TEST(ProbeRunner, runs_jobs_beside_the_calling_thread) {
  ThreadProbeRunner runner;
  EXPECT_TRUE(runner.is_idle());
  for (int n = 0; n < 3; ++n) {
    std::promise<void> may_end;
    std::promise<std::thread::id> ran_on;
    int written = 0;
    runner.start([&, may = may_end.get_future().share()] {
      ran_on.set_value(std::this_thread::get_id());
      may.wait();
      written = 7;
    });
    EXPECT_NE(ran_on.get_future().get(), std::this_thread::get_id());
    EXPECT_FALSE(runner.is_idle());
    may_end.set_value();
    while (!runner.is_idle()) std::this_thread::yield();
    EXPECT_EQ(written, 7);
  }
}

TEST(ProbeRunner, waits_for_its_job_at_its_end) {
  bool has_ended = false;
  std::promise<void> has_begun;
  {
    ThreadProbeRunner runner;
    runner.start([&] {
      has_begun.set_value();
      has_ended = true;
    });
    has_begun.get_future().wait();
  }
  EXPECT_TRUE(has_ended);
}

}  // namespace
}  // namespace cyclorama::output
