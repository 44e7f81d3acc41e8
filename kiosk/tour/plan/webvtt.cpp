// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/webvtt.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>

#include "common/base/text.h"
#include "common/base/text_lines.h"
#include "kiosk/tour/plan/characters.h"

namespace cyclorama::tour {
namespace {

constexpr std::string_view kArrow = "-->";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// The file's lines, counted from 1.
class Lines {
 public:
  explicit Lines(std::string_view text) : reader_(text) { next(); }
  [[nodiscard]] bool is_over() const { return is_over_; }
  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] std::size_t number() const { return number_; }
  void next() {
    is_over_ = !reader_.next(&line_);
    if (is_over_) line_ = {};
    if (!is_over_) ++number_;
  }

 private:
  LineReader reader_;
  std::string_view line_;
  std::size_t number_ = 0;
  bool is_over_ = false;
};

std::optional<int> digits(std::string_view text, std::size_t min_count, std::size_t max_count) {
  if (text.size() < min_count || text.size() > max_count) return std::nullopt;
  int number = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return std::nullopt;
    number = 10 * number + (c - '0');
  }
  return number;
}

/// Parses "hh:mm:ss.ttt", or "mm:ss.ttt".
std::optional<Duration> parse_time(std::string_view text) {
  constexpr int kSixty = 60;
  constexpr std::size_t kMaxHourDigits = 4;
  const std::size_t point = text.find('.');
  if (point == text.npos) return std::nullopt;
  const auto thousandths = digits(text.substr(point + 1), 3, 3);
  std::string_view whole = text.substr(0, point);
  const std::size_t seconds_at = whole.rfind(':');
  if (!thousandths || seconds_at == whole.npos) return std::nullopt;
  const auto seconds = digits(whole.substr(seconds_at + 1), 2, 2);
  whole = whole.substr(0, seconds_at);
  const std::size_t minutes_at = whole.rfind(':');
  const auto minutes = digits(minutes_at == whole.npos ? whole : whole.substr(minutes_at + 1), 2, 2);
  const auto hours =
      minutes_at == whole.npos ? std::optional(0) : digits(whole.substr(0, minutes_at), 2, kMaxHourDigits);
  if (!seconds || !minutes || !hours || *seconds >= kSixty || *minutes >= kSixty) return std::nullopt;
  return std::chrono::hours(*hours) + std::chrono::minutes(*minutes) + std::chrono::seconds(*seconds) +
         std::chrono::milliseconds(*thousandths);
}

/// Returns the text without tags, with its character references replaced by their characters.
std::string without_markup(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kReferences{{{"&amp;", "&"},
                                                                                      {"&lt;", "<"},
                                                                                      {"&gt;", ">"},
                                                                                      {"&nbsp;", "\xC2\xA0"},
                                                                                      {"&lrm;", "\xE2\x80\x8E"},
                                                                                      {"&rlm;", "\xE2\x80\x8F"}}};
  std::string plain;
  while (!text.empty()) {
    if (text.front() == '<') {
      const std::size_t end = text.find('>');
      text.remove_prefix(end == text.npos ? text.size() : end + 1);
      continue;
    }
    std::string_view taken = text.substr(0, 1);
    std::string_view put = taken;
    for (const auto& [reference, character] : kReferences) {
      if (!text.starts_with(reference)) continue;
      taken = reference;
      put = character;
    }
    plain += put;
    text.remove_prefix(taken.size());
  }
  return plain;
}

class CueReader {
 public:
  CueReader(std::string_view text, const std::string& name) : lines_(text), name_(name) {}

  Result<std::vector<Cue>> read() {
    constexpr std::string_view kTitle = "WEBVTT";
    std::string_view first = lines_.line();
    if (first.starts_with(kByteOrderMark)) first.remove_prefix(kByteOrderMark.size());
    const bool is_titled = first.starts_with(kTitle) && (first.size() == kTitle.size() || first[kTitle.size()] == ' ' ||
                                                         first[kTitle.size()] == '\t');
    if (!is_titled) return wrong("a file of captions begins with the line WEBVTT");
    skip_block();
    while (!lines_.is_over()) {
      if (trimmed(lines_.line()).empty()) {
        lines_.next();
      } else {
        TRY(read_block());
      }
    }
    return std::move(cues_);
  }

 private:
  [[nodiscard]] Error wrong(const std::string& what) const {
    return Error(ErrorCode::kBadData, fmt::format("{}:{}: {}", name_, lines_.number(), what));
  }
  [[nodiscard]] bool has_arrow() const { return lines_.line().find(kArrow) != std::string_view::npos; }
  void skip_block() {
    while (!lines_.is_over() && !trimmed(lines_.line()).empty()) lines_.next();
  }
  [[nodiscard]] bool begins_with_word(std::string_view word) const {
    const std::string_view line = lines_.line();
    return line.starts_with(word) &&
           (line.size() == word.size() || line[word.size()] == ' ' || line[word.size()] == '\t');
  }

  Status read_block() {
    if (begins_with_word("NOTE") || begins_with_word("STYLE") || begins_with_word("REGION")) {
      skip_block();
      return Done{};
    }
    if (!has_arrow()) {
      lines_.next();  // The caption's name.
      if (!has_arrow()) return wrong("a caption needs a line with its times, such as 00:01.000 --> 00:04.000");
    }
    TRY_ASSIGN(Cue cue, read_times());
    return read_text(std::move(cue));
  }

  Result<Cue> read_times() {
    const std::size_t arrow = lines_.line().find(kArrow);
    const std::string_view after = trimmed(lines_.line().substr(arrow + kArrow.size()));
    const auto begin = parse_time(trimmed(lines_.line().substr(0, arrow)));
    const auto end = parse_time(after.substr(0, after.find_first_of(" \t")));
    if (!begin || !end) return wrong("times have the form 00:01.000 --> 00:04.000, with hours before them if needed");
    if (*end <= *begin) return wrong("the caption ends before it begins; exchange its times");
    if (*end > kMaxCueTime)
      return wrong(fmt::format("the caption ends after {} minutes, the longest that a narration may be",
                               std::chrono::duration_cast<std::chrono::minutes>(kMaxCueTime).count()));
    if (!cues_.empty() && *begin < cues_.back().begin)
      return wrong("the caption begins before the one above it; put them in the order of their times");
    if (cues_.size() == kMaxCues) return wrong(fmt::format("is one caption too many; a file has at most {}", kMaxCues));
    return Cue{*begin, *end, {}};
  }

  Status read_text(Cue cue) {
    const std::size_t number = lines_.number();
    std::string raw;
    for (lines_.next(); !trimmed(lines_.line()).empty(); lines_.next()) {
      if (has_arrow()) return wrong("an empty line is missing before these times");
      if (printable(lines_.line(), lines_.line().size()) != lines_.line())
        return wrong("has control characters, or is not in UTF-8; save the file as UTF-8");
      raw += fmt::format("{}{}", raw.empty() ? "" : "\n", trimmed(lines_.line()));
    }
    cue.text = without_markup(raw);
    if (const std::size_t count = character_count(cue.text); count > kMaxCueCharacters)
      return Error(ErrorCode::kBadData,
                   fmt::format("{}:{}: the caption has {} letters; at most {} are allowed, so make several of it",
                               name_, number, count, kMaxCueCharacters));
    if (!trimmed(cue.text).empty()) cues_.push_back(std::move(cue));
    return Done{};
  }

  Lines lines_;
  const std::string& name_;
  std::vector<Cue> cues_;
};

}  // namespace

Result<std::vector<Cue>> parse_webvtt(std::string_view text, const std::string& name) {
  return CueReader(text, name).read();
}

}  // namespace cyclorama::tour
