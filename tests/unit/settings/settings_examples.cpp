// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/settings/settings_examples.h"

#include <algorithm>
#include <regex>

namespace cyclorama {
namespace {

constexpr std::string_view kFence = "```";

struct Line {
  int number;
  std::string text;
};

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back({static_cast<int>(lines.size()) + 1, std::string(text.substr(begin, end - begin))});
    begin = end + 1;
  }
  return lines;
}

/// Reads a line such as "# site.toml", "# installation.toml, in part" or "# camera"; returns false for any other line.
bool read_marker(const std::string& line, SettingsExample* ret) {
  static const std::regex kMarker(R"(\s*#\s*([a-z_]+\.toml|camera|turntable)(, in part)?\s*)");
  std::smatch match;
  if (!std::regex_match(line, match, kMarker)) return false;
  ret->file_name = match[1];
  ret->is_in_part = match[2].matched;
  return true;
}

bool looks_like_a_setting(const std::string& line) {
  static const std::regex kTable(R"(\s*\[\[?[a-z_]+(\.[a-z_]+)*\]\]?\s*(#.*)?)");
  static const std::regex kKey(R"re(\s*[a-z_0-9.]+ = ("[^"]*"|\[.*|-?[0-9][0-9.e]*|true|false)\s*(#.*)?)re");
  if (line.find('[') == std::string::npos && line.find('=') == std::string::npos) return false;
  return std::regex_match(line, kTable) || std::regex_match(line, kKey);
}

/// Adds the block as an example if its file is named or if it looks like settings.
void add_block(const std::vector<Line>& block, const std::string& named_by_others, std::vector<SettingsExample>* ret) {
  if (block.empty()) return;
  SettingsExample example{block.front().number, {}, false, {}};
  const bool is_marked = read_marker(block.front().text, &example);
  if (!is_marked) example.file_name = named_by_others;
  const bool is_settings =
      std::any_of(block.begin(), block.end(), [](const Line& l) { return looks_like_a_setting(l.text); });
  if (!is_marked && !is_settings && named_by_others.empty()) return;
  for (const Line& line : block) example.text += line.text + "\n";
  ret->push_back(std::move(example));
}

std::vector<SettingsExample> examples_of_document(const std::vector<Line>& lines) {
  static const std::regex kHeading(R"(#+ ([a-z_]+\.toml))");
  std::vector<SettingsExample> examples;
  std::vector<Line> block;
  std::string heading, named;
  bool is_fenced = false;
  const auto end_block = [&] {
    add_block(block, named, &examples);
    block.clear();
    named.clear();
  };
  for (const Line& line : lines) {
    std::smatch match;
    if (line.text.starts_with(kFence)) {
      end_block();
      is_fenced = !is_fenced;
      if (is_fenced && line.text == "```toml") named = heading.empty() ? "?" : heading;
    } else if (is_fenced) {
      block.push_back(line);
    } else if (line.text.starts_with("    ")) {
      block.push_back({line.number, line.text.substr(4)});
    } else {
      end_block();
      if (line.text.starts_with("#")) heading = std::regex_match(line.text, match, kHeading) ? match[1].str() : "";
    }
  }
  end_block();
  return examples;
}

std::vector<SettingsExample> examples_of_source(const std::vector<Line>& lines) {
  std::vector<SettingsExample> examples;
  std::vector<Line> block;
  for (const Line& line : lines) {
    const std::size_t begin = std::min(line.text.find_first_not_of(' '), line.text.size());
    const std::string_view comment = std::string_view(line.text).substr(begin);
    if (comment.starts_with("///   ") || comment.starts_with("//   ")) {
      block.push_back({line.number, std::string(comment.substr(comment.find(' ') + 3))});
    } else {
      add_block(block, "", &examples);
      block.clear();
    }
  }
  add_block(block, "", &examples);
  return examples;
}

}  // namespace

std::vector<SettingsExample> settings_examples(std::string_view text, bool is_document) {
  const std::vector<Line> lines = lines_of(text);
  return is_document ? examples_of_document(lines) : examples_of_source(lines);
}

}  // namespace cyclorama
