// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/walkable/walkable_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <vector>

#include "common/base/text_lines.h"

namespace cyclorama::walkable {
namespace {

constexpr std::size_t kPointsPerLine = 8;

std::string points_text(const std::vector<Eigen::Vector2d>& points) {
  std::string text = "[";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) text += i % kPointsPerLine == 0 ? ",\n  " : ", ";
    // Millimetres, which are finer than the cells of the search.
    fmt::format_to(std::back_inserter(text), "[{:.3f}, {:.3f}]", points[i].x(), points[i].y());
  }
  return text + "]";
}

/// A line of a TOML file. All lines of a value that spans several lines have the same key.
struct Line {
  std::string text;
  std::string section;  ///< "visitor" below [visitor], "visitor.hole" below [[visitor.hole]], "" at the top.
  std::string key;  ///< Key whose value begins or continues in this line; empty for headers, comments and blank lines.
  bool is_header = false;
};

/// Tracks brackets, quotes and comments from line to line. Precondition: the text is valid TOML.
class Scanner {
 public:
  /// Returns true if the next line continues the value before it.
  [[nodiscard]] bool is_within() const { return depth_ > 0 || !quote_.empty(); }
  void pass(std::string_view line) {
    for (std::size_t i = 0; i < line.size();) {
      if (!quote_.empty()) {
        const std::size_t end = line.find(quote_, i);
        if (end == std::string_view::npos) return;
        i = end + quote_.size();
        quote_.clear();
      } else if (line.substr(i, 3) == "\"\"\"" || line.substr(i, 3) == "'''") {
        quote_ = line.substr(i, 3);
        i += 3;
      } else if (line[i] == '"' || line[i] == '\'') {
        i = after_text(line, i);
      } else if (line[i] == '#') {
        return;
      } else {
        depth_ += line[i] == '[' || line[i] == '{' ? 1 : line[i] == ']' || line[i] == '}' ? -1 : 0;
        ++i;
      }
    }
  }

 private:
  static std::size_t after_text(std::string_view line, std::size_t begin) {
    const char quote = line[begin];
    for (std::size_t i = begin + 1; i < line.size(); ++i) {
      if (quote == '"' && line[i] == '\\') {
        ++i;
      } else if (line[i] == quote) {
        return i + 1;
      }
    }
    return line.size();
  }
  int depth_ = 0;
  std::string quote_;  ///< Delimiter of the multi-line string being read; empty outside of one.
};

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  Scanner scanner;
  std::istringstream in{std::string(text)};
  std::string section;
  std::string key;
  for (std::string raw; std::getline(in, raw);) {
    Line line{raw, section, {}, false};
    const std::string_view start = trimmed(raw);
    if (scanner.is_within()) {
      line.key = key;
    } else if (start.starts_with("[")) {
      const std::size_t name = start.find_first_not_of('[');
      section = trimmed(start.substr(name, start.find(']') - name));
      line.section = section;
      line.is_header = true;
    } else if (!start.empty() && !start.starts_with("#")) {
      key = trimmed(start.substr(0, start.find('=')));
      line.key = key;
    }
    scanner.pass(raw);
    lines.push_back(std::move(line));
  }
  return lines;
}

/// Returns true for visitor = {...} or visitor.eye_height_m = 1.6: a table without a header below which keys could be
/// written.
bool is_without_header(const std::vector<Line>& lines, std::string_view name) {
  const auto names = [&](const Line& line) {
    return line.section.empty() && !line.is_header &&
           (line.key == name || line.key.starts_with(fmt::format("{}.", name)));
  };
  return std::any_of(lines.begin(), lines.end(), names);
}

bool has_header(const std::vector<Line>& lines, std::string_view name) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const Line& line) { return line.is_header && line.section == name; });
}

}  // namespace

std::string walkable_key(const WalkableGround& ground) { return "walkable_m = " + points_text(ground.outline) + "\n"; }

std::string hole_tables(const WalkableGround& ground) {
  std::string text;
  for (const auto& hole : ground.holes) text += "[[visitor.hole]]\ncorners_m = " + points_text(hole) + "\n\n";
  return text;
}

Result<std::string> with_walkable(std::string_view text, const std::string& name, const WalkableGround& ground,
                                  const Eigen::Vector3d& start_eye) {
  const std::vector<Line> lines = lines_of(text);
  for (const std::string_view table : {"visitor", "start"}) {
    if (!is_without_header(lines, table)) continue;
    return Error(ErrorCode::kBadData, fmt::format("{}: '{}' has no header [{}] of its own; write it with one, or paste "
                                                  "the area there",
                                                  name, table, table));
  }
  const bool has_eye = std::any_of(lines.begin(), lines.end(),
                                   [](const Line& line) { return line.section == "start" && line.key == "eye_m"; });
  const std::string eye =
      has_eye ? "" : fmt::format("eye_m = [{}, {}, {}]\n", start_eye.x(), start_eye.y(), start_eye.z());
  std::string out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    if (line.section == "visitor" && line.key == "walkable_m") continue;
    // Removes all lines of a hole except comments, which may belong to the next header.
    if (line.section == "visitor.hole" && (line.is_header || !line.key.empty())) continue;
    if (line.section == "visitor.hole" && trimmed(line.text).empty()) continue;
    out += line.text + "\n";
    if (line.is_header && line.section == "visitor") out += walkable_key(ground);
    if (line.is_header && line.section == "start") out += eye;
  }
  if (!has_eye && !has_header(lines, "start")) out += "\n[start]\n" + eye;
  if (!has_header(lines, "visitor")) out += "\n[visitor]\n" + walkable_key(ground);
  if (!ground.holes.empty()) out += "\n" + hole_tables(ground);
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

}  // namespace cyclorama::walkable
