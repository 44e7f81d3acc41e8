// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cyclorama {

/// An example of settings in a document or in a header's comment.
///
/// In a header (`/// ` and two blanks before each line) and in an indented block of a document, the first line names
/// the settings file. For a block that is fenced with ```toml, the nearest heading may name it instead:
///
///   # tracker.toml
///   steer_by = "body"
///
/// "# installation.toml, in part" marks lines that are not a complete file. "# camera" and "# turntable" mark lines for
/// make_camera() and make_turntable(): one device per line, and a remark after "  #".
struct SettingsExample {
  int line = 0;           ///< Number of the first line, from 1.
  std::string file_name;  ///< For instance "tracker.toml"; empty if nothing names the file.
  bool is_in_part = false;
  std::string text;
};

/// Returns the examples in a document (.md) or a source (.h, .proto): blocks that are named, and blocks that look like
/// settings.
[[nodiscard]] std::vector<SettingsExample> settings_examples(std::string_view text, bool is_document);

/// Returns the mistakes in an example of the document `path`, one sentence each, as the product's own parsers of that
/// file report them. Lines that are commented out (`# key = value`) must be valid settings, too.
[[nodiscard]] std::vector<std::string> mistakes_of(const SettingsExample& example, const std::string& path);

}  // namespace cyclorama
