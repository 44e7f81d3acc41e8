// SPDX-License-Identifier: Apache-2.0
#include "drivers/turntable/serial/gcode.h"

#include <fmt/format.h>

#include <cmath>

#include "common/base/text.h"

namespace cyclorama::gcode {
namespace {

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// Finds "X:30.00" among the words before "Count"; the words after it are motor steps.
std::optional<double> position_in(std::string_view line, char axis) {
  while (!line.empty()) {
    const std::size_t end = line.find_first_of(" \t");
    const std::string_view word = line.substr(0, end);
    line = end == std::string_view::npos ? std::string_view() : without_blanks(line.substr(end));
    if (word == "Count") return std::nullopt;
    if (word.size() < 2 || word[0] != axis || word[1] != ':') continue;
    // Some controllers write "X: 30.00".
    const std::string_view rest = word.size() > 2 ? word.substr(2) : line.substr(0, line.find_first_of(" \t"));
    const auto value = parse_double(rest);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    return value;
  }
  return std::nullopt;
}

bool is_letter_and_colon(std::string_view line) {
  return line.size() > 2 && line[0] >= 'A' && line[0] <= 'Z' && line[1] == ':';
}

}  // namespace

Answer parse_answer(std::string_view line, char axis) {
  line = without_blanks(line);
  Answer answer;
  answer.text = printable(line, 120);
  if (line == "ok" || line.starts_with("ok ")) {
    answer.kind = Answer::Kind::kOk;
  } else if (line.starts_with("Error:") || line.starts_with("error:") || line.starts_with("!!")) {
    answer.kind = Answer::Kind::kError;
  } else if (line == "start") {
    answer.kind = Answer::Kind::kRestart;
  } else if (line.starts_with("Resend:") || line.starts_with("rs ")) {
    answer.kind = Answer::Kind::kResend;
  } else if (line.starts_with("echo:busy:")) {
    answer.kind = Answer::Kind::kBusy;
  } else if (is_letter_and_colon(line)) {
    if (const auto position = position_in(line, axis)) {
      answer.kind = Answer::Kind::kPosition;
      answer.position = *position;
    }
  }
  return answer;
}

std::optional<std::string> LineCutter::next() {
  const std::size_t end = bytes_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = bytes_.substr(0, end);
  bytes_.erase(0, end + 1);
  return line;
}

std::string home_command(char axis) { return fmt::format("G28 {}", axis); }

std::string go_command(char axis, double units, double units_per_minute) {
  return fmt::format("G0 {}{:.4f} F{:.0f}", axis, units, units_per_minute);
}

}  // namespace cyclorama::gcode
