// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cyclorama {

/// Settings that a document or a header shows to people.
///
/// In a header (`/// ` and two blanks before each line) and in an indented block of a document the first line names the
/// file that they belong to. A block that is fenced with ```toml may leave that to its nearest heading:
///
///   # tracker.toml
///   steer_by = "body"
///
/// "# installation.toml, in part" is for lines that are no whole file. "# camera" and "# turntable" come before
/// lines for make_camera() and make_turntable(), one device each, with a remark after "  #".
struct SettingsExample {
  int line = 0;           ///< The first line's number, from 1.
  std::string file_name;  ///< "tracker.toml"; empty: nothing names it.
  bool is_in_part = false;
  std::string text;
};

/// Returns the examples in a document (.md) or a source (.h, .proto): blocks that are named, and blocks that look like
/// settings.
[[nodiscard]] std::vector<SettingsExample> settings_examples(std::string_view text, bool is_document);

/// Returns the mistakes of an example in `path`, one sentence each, by the parsers that read such a file in the
/// product.
/// Lines that are commented out (`# key = value`) must name settings too.
[[nodiscard]] std::vector<std::string> mistakes_of(const SettingsExample& example, const std::string& path);

}  // namespace cyclorama
