// SPDX-License-Identifier: Apache-2.0
#include "common/config/toml_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "common/config/safe_toml.h"

namespace cyclorama {
namespace {

Result<toml::table> parsed(std::string_view text, std::string_view name) {
  toml::parse_result result = toml::parse(text, std::string(name));
  if (result) return std::move(result).table();
  return Error(ErrorCode::kBadData, fmt::format("{}:{}: is not TOML: {}", name, result.error().source().begin.line,
                                                result.error().description()));
}

Error unwritable(std::string_view name, std::string_view what) {
  return {ErrorCode::kBadData, fmt::format("{}: [{}] is written in a way that only a person can change; edit the file, "
                                           "and bring it on a USB stick",
                                           name, what)};
}

/// Collects the lines on which a table's header stands; `within` limits it to one table of the root.
void collect_headers(const toml::table& table, std::vector<std::size_t>* lines) {
  for (const auto& [key, node] : table) {
    if (const toml::table* const inner = node.as_table(); inner != nullptr && !inner->is_inline()) {
      lines->push_back(inner->source().begin.line);
      collect_headers(*inner, lines);
    } else if (const toml::array* const array = node.as_array()) {
      for (const toml::node& one : *array) {
        const toml::table* const element = one.as_table();
        if (element == nullptr || element->is_inline()) continue;
        lines->push_back(element->source().begin.line);
        collect_headers(*element, lines);
      }
    }
  }
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1);
    lines.emplace_back(text.substr(0, end + 1));
    text.remove_prefix(end + 1);
  }
  return lines;
}

/// Returns the text without the lines from each header of the table to the next header of another one. Comments directly
/// above that next header stay with it.
std::string without(std::string_view text, const toml::table& root, std::string_view table) {
  const toml::table* const removed = root[table].as_table();
  std::vector<std::size_t> ours{removed->source().begin.line};
  collect_headers(*removed, &ours);
  std::vector<std::size_t> all;
  collect_headers(root, &all);
  std::ranges::sort(all);
  std::vector<std::string> lines = lines_of(text);
  std::vector<bool> is_gone(lines.size() + 1, false);
  for (const std::size_t begin : ours) {
    const auto next = std::ranges::upper_bound(all, begin);
    std::size_t end = next == all.end() ? lines.size() + 1 : *next;
    const auto is_comment = [&](std::size_t line) { return lines[line - 1].starts_with('#'); };
    while (next != all.end() && end > begin + 1 && is_comment(end - 1)) --end;
    for (std::size_t line = begin; line < end && line <= lines.size(); ++line) is_gone[line] = true;
  }
  std::string kept;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!is_gone[i + 1]) kept += lines[i];
  }
  return kept;
}

std::string ended(std::string text) {
  if (!text.empty() && !text.ends_with('\n')) text += '\n';
  return text;
}

/// Checks that a change did what was wanted, and nothing else.
Status check(std::string_view text, std::string_view name, std::string_view table, const toml::table& expected) {
  TRY_ASSIGN(const toml::table found, parsed(text, name));
  if (found == expected) return Done{};
  return unwritable(name, table);
}

/// Returns the place in `text` of a position in lines and columns; columns count characters, of which UTF-8 has several
/// bytes.
std::size_t offset_of(std::string_view text, const toml::source_position& position) {
  std::size_t at = 0;
  for (std::size_t line = 1; line < position.line; ++line) at = std::min(text.find('\n', at), text.size() - 1) + 1;
  const auto is_inside_character = [&] {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  for (std::size_t column = 1; column < position.column && at < text.size(); ++column) {
    ++at;
    while (is_inside_character()) ++at;
  }
  return at;
}

}  // namespace

Result<std::string> with_table(std::string_view text, std::string_view name, std::string_view table,
                               std::string_view lines) {
  TRY_ASSIGN(toml::table expected, parsed(text, name));
  TRY_ASSIGN(const toml::table wanted, parsed(lines, name));
  const bool is_there = expected.contains(table);
  const toml::table* const present = expected[table].as_table();
  if (is_there && (present == nullptr || present->is_inline())) return unwritable(name, table);
  std::string changed = ended(is_there ? without(text, expected, table) : std::string(text));
  if (!lines.empty()) changed += (changed.empty() ? "" : "\n") + ended(std::string(lines));
  expected.erase(table);
  if (const toml::node* const node = wanted.get(table)) expected.insert(table, *node);
  TRY(check(changed, name, table, expected));
  return changed;
}

Result<std::string> with_value(std::string_view text, std::string_view name, std::string_view table,
                               std::string_view key, std::string_view value) {
  TRY_ASSIGN(toml::table expected, parsed(text, name));
  TRY_ASSIGN(const toml::table wanted, parsed(fmt::format("value = {}\n", value), name));
  std::string changed(text);
  if (!expected.contains(table)) {
    changed = ended(changed) + fmt::format("{}[{}]\n{} = {}\n", text.empty() ? "" : "\n", table, key, value);
    expected.insert(table, toml::table{});
  } else if (expected[table].as_table() == nullptr) {
    return unwritable(name, table);
  } else if (const toml::node* const present = expected[table].as_table()->get(key)) {
    const std::size_t begin = offset_of(text, present->source().begin);
    const std::size_t end = offset_of(text, present->source().end);
    if (begin >= end || end > text.size()) return unwritable(name, table);
    changed.replace(begin, end - begin, value);
  } else {
    const std::size_t header = offset_of(text, {expected[table].as_table()->source().begin.line, 1});
    const std::size_t next = std::min(text.find('\n', header), text.size());
    changed = ended(changed);
    changed.insert(std::min(next + 1, changed.size()), fmt::format("{} = {}\n", key, value));
  }
  expected[table].as_table()->insert_or_assign(key, *wanted.get("value"));
  TRY(check(changed, name, table, expected));
  return changed;
}

}  // namespace cyclorama
