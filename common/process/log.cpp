// SPDX-License-Identifier: Apache-2.0
#include "common/process/log.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string>

#include "common/base/text.h"

namespace cyclorama {
namespace {

constexpr std::size_t kLongestLine = 2000;
std::atomic<int> least_level{static_cast<int>(LogLevel::kInfo)};

/// systemd names the device and inode of the journal's stream when standard error is one.
bool is_journal() {
  static const bool answer = [] {
    const char* const stream = std::getenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe): nobody sets it later.
    struct stat info {};
    return stream != nullptr && ::fstat(STDERR_FILENO, &info) == 0 &&
           fmt::format("{}:{}", info.st_dev, info.st_ino) == stream;
  }();
  return answer;
}

const char* word_for(LogLevel level) {
  switch (level) {
    case LogLevel::kError: return "error: ";
    case LogLevel::kWarning: return "warning: ";
    case LogLevel::kDebug: return "debug: ";
    case LogLevel::kNotice:
    case LogLevel::kInfo: break;
  }
  return "";
}

}  // namespace

void set_log_level(LogLevel least) { least_level = static_cast<int>(least); }

void log(LogLevel level, std::string_view message) {
  if (static_cast<int>(level) > least_level) return;
  const std::string text = printable(message, kLongestLine);
  const std::string line = is_journal() ? fmt::format("<{}>{}\n", static_cast<int>(level), text)
                                        : fmt::format("{}{}\n", word_for(level), text);
  // One write, so that lines of several threads and processes do not mix. Nothing helps if it fails, ignoring.
  if (::write(STDERR_FILENO, line.data(), line.size()) < 0) return;
}

}  // namespace cyclorama
