// SPDX-License-Identifier: Apache-2.0
#include "common/process/stop_signal.h"

#include <gtest/gtest.h>

#include <csignal>

#include "common/process/program.h"

namespace cyclorama {
namespace {

TEST(StopSignal, waits_until_the_deadline_and_stays_set_once_received) {
  const StopSignal stop;
  EXPECT_FALSE(stop.requested());
  EXPECT_FALSE(stop.wait_until(SteadyClock().now() + std::chrono::milliseconds(5)));
  ASSERT_EQ(std::raise(SIGTERM), 0);
  EXPECT_TRUE(stop.wait_until(SteadyClock().now() + std::chrono::seconds(5)));
  EXPECT_TRUE(stop.requested());
}

int run(std::vector<const char*> arguments, const Status& result) {
  Program program("cyclorama-test", "A test.");
  arguments.insert(arguments.begin(), "cyclorama-test");
  std::vector<char*> argv;
  for (const char* const argument : arguments) argv.push_back(const_cast<char*>(argument));
  return program.run(static_cast<int>(argv.size()), argv.data(), [&](const StopSignal&) { return result; });
}

TEST(Program, exit_codes_distinguish_success_failure_and_wrong_usage) {
  EXPECT_EQ(run({}, Done{}), kExitOk);
  EXPECT_EQ(run({"--help"}, Error(ErrorCode::kBusy, "not reached")), kExitOk);
  EXPECT_EQ(run({"--version"}, Error(ErrorCode::kBusy, "not reached")), kExitOk);
  EXPECT_EQ(run({}, Error(ErrorCode::kBusy, "held by another")), kExitFailed);
  EXPECT_EQ(run({"--no-such-option"}, Done{}), kExitUsage);
}

}  // namespace
}  // namespace cyclorama
