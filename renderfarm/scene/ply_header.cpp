// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "common/base/text.h"
#include "common/base/text_lines.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kHeaderLimitBytes = std::size_t{1} << 20;
constexpr std::size_t kElementLimit = 64;
constexpr std::size_t kPropertyLimit = 256;  // Per element.
constexpr std::size_t kTextureLimit = 1024;

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr std::array<TypeName, 16> kTypeNames = {{{"char", PlyType::kInt8},
                                                  {"int8", PlyType::kInt8},
                                                  {"uchar", PlyType::kUint8},
                                                  {"uint8", PlyType::kUint8},
                                                  {"short", PlyType::kInt16},
                                                  {"int16", PlyType::kInt16},
                                                  {"ushort", PlyType::kUint16},
                                                  {"uint16", PlyType::kUint16},
                                                  {"int", PlyType::kInt32},
                                                  {"int32", PlyType::kInt32},
                                                  {"uint", PlyType::kUint32},
                                                  {"uint32", PlyType::kUint32},
                                                  {"float", PlyType::kFloat32},
                                                  {"float32", PlyType::kFloat32},
                                                  {"double", PlyType::kFloat64},
                                                  {"float64", PlyType::kFloat64}}};

/// Reads the header line by line; `line` counts from 1.
struct HeaderReader {
  PlyHeader header;
  bool has_format = false;
  std::size_t line = 0;

  Error bad(std::string_view what) const {
    return Error(ErrorCode::kBadData, fmt::format("line {} of the PLY header {}", line, what));
  }

  Result<PlyType> type_of(std::string_view name) const {
    for (const TypeName& known : kTypeNames) {
      if (known.name == name) return known.type;
    }
    return bad(fmt::format("has the type '{}', which is not part of PLY", printable(name)));
  }

  Status read_format(std::string_view rest) {
    const std::string_view encoding = next_word(&rest);
    if (encoding == "ascii") {
      header.encoding = PlyEncoding::kAscii;
    } else if (encoding == "binary_little_endian") {
      header.encoding = PlyEncoding::kLittleEndian;
    } else if (encoding == "binary_big_endian") {
      header.encoding = PlyEncoding::kBigEndian;
    } else {
      return bad(fmt::format("has the format '{}'; ascii and binary_little_endian can be read", printable(encoding)));
    }
    has_format = true;
    return Done{};
  }

  Status read_element(std::string_view rest) {
    PlyElement element;
    element.name = next_word(&rest);
    const std::string_view count = next_word(&rest);
    const auto value = parse_integer(count);
    if (element.name.empty() || !value || *value < 0) {
      return bad(fmt::format("must read 'element NAME COUNT'; its count is '{}'", printable(count)));
    }
    if (header.elements.size() == kElementLimit) return bad(fmt::format("is the element after {}", kElementLimit));
    element.count = static_cast<std::uint64_t>(*value);
    header.elements.push_back(std::move(element));
    return Done{};
  }

  Status read_property(std::string_view rest) {
    if (header.elements.empty()) return bad("is a property before any element");
    PlyElement& element = header.elements.back();
    if (element.properties.size() == kPropertyLimit)
      return bad(fmt::format("is the property after {}", kPropertyLimit));
    PlyProperty property;
    std::string_view type = next_word(&rest);
    if (type == "list") {
      TRY_ASSIGN(property.count_type, type_of(next_word(&rest)));
      if (is_float(*property.count_type)) return bad("counts a list in floating point");
      type = next_word(&rest);
    }
    TRY_ASSIGN(property.type, type_of(type));
    property.name = next_word(&rest);
    if (property.name.empty()) return bad("is a property without a name");
    element.properties.push_back(std::move(property));
    return Done{};
  }

  Status read_comment(std::string_view rest) {
    if (next_word(&rest) != "TextureFile") return Done{};
    if (header.texture_files.size() == kTextureLimit) return bad(fmt::format("is the texture after {}", kTextureLimit));
    header.texture_files.emplace_back(trimmed(rest));
    return Done{};
  }

  /// Returns true if the words after a misspelt keyword may be those of a property or an element. If such a line were
  /// skipped, all later values would have another meaning.
  static bool may_declare(std::string_view rest) {
    std::string_view last;
    for (std::string_view word = next_word(&rest); !word.empty(); word = next_word(&rest)) {
      const auto is_word = [&](const TypeName& known) { return known.name == word; };
      if (word == "list" || std::any_of(kTypeNames.begin(), kTypeNames.end(), is_word)) return true;
      last = word;
    }
    return parse_integer(last).has_value();
  }

  /// Reads any line except the first and the last.
  Status read_line(std::string_view text) {
    const std::string_view keyword = next_word(&text);
    if (keyword == "format") return read_format(text);
    if (keyword == "element") return read_element(text);
    if (keyword == "property") return read_property(text);
    if (keyword == "comment") return read_comment(text);
    if (keyword == "obj_info" || keyword.empty()) return Done{};
    if (!may_declare(text)) {
      ++header.stray_lines;
      return Done{};
    }
    return bad(fmt::format("begins with '{}', which is not part of PLY", printable(keyword)));
  }
};

Status check_counts(const PlyHeader& header, std::size_t body_bytes) {
  std::size_t left = body_bytes;
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) {
      return Error(ErrorCode::kBadData, fmt::format("the PLY element '{}' has no properties", printable(element.name)));
    }
    const std::size_t min = element.min_row_bytes(header.encoding);
    // One byte is added because the last line may lack its line end.
    if (element.count > left / min + 1 || element.count * min > left + 1) {
      return Error(
          ErrorCode::kBadData,
          fmt::format("the header announces {} rows of '{}', but the file ends {} bytes after the header: it is "
                      "cut short; copy it again",
                      element.count, printable(element.name), body_bytes));
    }
    left -= std::min(left, static_cast<std::size_t>(element.count) * min);
  }
  return Done{};
}

}  // namespace

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      return 8;
  }
  return 1;
}

std::size_t PlyElement::min_row_bytes(PlyEncoding encoding) const {
  if (encoding == PlyEncoding::kAscii) return 2 * properties.size();  // One digit and one separator.
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += size_of(property.count_type.value_or(property.type));
  return bytes;
}

Result<PlyHeader> parse_ply_header(std::span<const std::byte> file) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()), std::min(file.size(), kHeaderLimitBytes));
  HeaderReader reader;
  LineReader lines(text);
  std::string_view line;
  while (lines.next(&line)) {
    ++reader.line;
    if (reader.line == 1) {
      if (trimmed(line) != "ply")
        return Error(ErrorCode::kBadData, "this is not a PLY file: it does not begin with 'ply'");
    } else if (trimmed(line) == "end_header") {
      if (!reader.has_format) return Error(ErrorCode::kBadData, "the PLY header has no 'format' line");
      reader.header.body_offset = lines.offset();
      reader.header.body_line = reader.line + 1;
      TRY(check_counts(reader.header, file.size() - lines.offset()));
      return std::move(reader.header);
    } else {
      TRY(reader.read_line(line));
    }
  }
  return Error(ErrorCode::kBadData, "the PLY header has no end ('end_header'): the file is cut short or damaged");
}

}  // namespace cyclorama::scene
