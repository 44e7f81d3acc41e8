// SPDX-License-Identifier: Apache-2.0
#include "common/process/log.h"

#include <gtest/gtest.h>

#include <array>

namespace cyclorama {
namespace {

/// Returns the output of one call if standard error is not the journal.
std::string logged(LogLevel level, const std::string& message, std::span<const LogField> fields = {}) {
  testing::internal::CaptureStderr();
  log(level, message, fields);
  return testing::internal::GetCapturedStderr();
}

TEST(Log, prints_one_plain_line) {
  EXPECT_EQ(logged(LogLevel::kInfo, "all is well"), "all is well\n");
  EXPECT_EQ(logged(LogLevel::kWarning, "look\nhere"), "warning: look?here\n");
  const std::array<LogField, 2> fields{{{"CYCLORAMA_NODE", "render-07"}, {"CYCLORAMA_MUSEUM", ""}}};
  EXPECT_EQ(logged(LogLevel::kInfo, "it came", fields), "it came\n") << "fields are the journal's";
}

TEST(Log, omits_what_is_below_its_level) {
  EXPECT_EQ(logged(LogLevel::kDebug, "a detail"), "");
  set_log_level(LogLevel::kDebug);
  EXPECT_EQ(logged(LogLevel::kDebug, "a detail"), "debug: a detail\n");
  set_log_level(LogLevel::kInfo);
}

}  // namespace
}  // namespace cyclorama
