// SPDX-License-Identifier: Apache-2.0
#include "common/process/log.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/uio.h>
#define SD_JOURNAL_SUPPRESS_LOCATION  // Otherwise, every entry would name this file as its location.
#include <systemd/sd-journal.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string>
#include <vector>

#include "common/base/text.h"

namespace cyclorama {
namespace {

constexpr std::size_t kMaxLineBytes = 2000;
constexpr std::size_t kMaxFieldBytes = 200;
std::atomic<int> min_level{static_cast<int>(LogLevel::kInfo)};

/// True if standard error is the journal's stream, whose device and inode systemd passes.
bool is_journal() {
  static const bool answer = [] {
    const char* const stream = std::getenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe): never set later.
    struct stat info {};
    return stream != nullptr && ::fstat(STDERR_FILENO, &info) == 0 &&
           fmt::format("{}:{}", info.st_dev, info.st_ino) == stream;
  }();
  return answer;
}

/// Sends an entry in the journal's native form. Returns false if the journal does not accept it.
bool send_to_journal(LogLevel level, const std::string& text, std::span<const LogField> fields) {
  std::vector<std::string> entry{"MESSAGE=" + text, fmt::format("PRIORITY={}", static_cast<int>(level))};
  for (const LogField& field : fields) {
    if (!field.value.empty()) entry.push_back(fmt::format("{}={}", field.name, printable(field.value, kMaxFieldBytes)));
  }
  std::vector<iovec> parts;
  for (std::string& part : entry) parts.push_back({part.data(), part.size()});
  return sd_journal_sendv(parts.data(), static_cast<int>(parts.size())) == 0;
}

const char* word_for(LogLevel level) {
  switch (level) {
    case LogLevel::kError:
      return "error: ";
    case LogLevel::kWarning:
      return "warning: ";
    case LogLevel::kDebug:
      return "debug: ";
    case LogLevel::kNotice:
    case LogLevel::kInfo:
      break;
  }
  return "";
}

}  // namespace

void set_log_level(LogLevel min) { min_level = static_cast<int>(min); }

void log(LogLevel level, std::string_view message, std::span<const LogField> fields) {
  if (static_cast<int>(level) > min_level) return;
  const std::string text = printable(message, kMaxLineBytes);
  if (!fields.empty() && is_journal() && send_to_journal(level, text, fields)) return;
  const std::string line = is_journal() ? fmt::format("<{}>{}\n", static_cast<int>(level), text)
                                        : fmt::format("{}{}\n", word_for(level), text);
  // A single write, so that lines of several threads and processes do not mix. A failure cannot be reported anywhere.
  if (::write(STDERR_FILENO, line.data(), line.size()) < 0) return;
}

}  // namespace cyclorama
