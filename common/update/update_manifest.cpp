// SPDX-License-Identifier: Apache-2.0
#include "common/update/update_manifest.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.h"

namespace cyclorama {
namespace {

constexpr std::size_t kDigits = 64;
constexpr std::size_t kMaxTokenLength = 64;
constexpr std::array<std::string_view, 3> kEnds{".efi", ".root.raw", ".verity.raw"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_hexadecimal(char c) { return is_digit(c) || (c >= 'a' && c <= 'f'); }

/// Removes the first number and the dot after it from `left`. Returns the number without leading zeros.
std::string_view take_number(std::string_view* left) {
  const std::size_t end = std::min(left->find('.'), left->size());
  std::string_view number = left->substr(0, end);
  left->remove_prefix(std::min(end + 1, left->size()));
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

/// Returns the version in a name such as "IMAGE_VERSION.efi" or "IMAGE_VERSION_UUID.root.raw"; empty for another name.
std::string_view version_in(std::string_view name, std::string_view image, std::size_t kind) {
  if (!name.starts_with(image) || !name.ends_with(kEnds[kind])) return {};
  name.remove_prefix(image.size());
  if (name.size() <= kEnds[kind].size() || !name.starts_with('_')) return {};
  name = name.substr(1, name.size() - 1 - kEnds[kind].size());
  const std::size_t at = name.find('_');
  if ((at == std::string_view::npos) != (kind == 0)) return {};
  const std::string_view uuid = at == std::string_view::npos ? "" : name.substr(at + 1);
  const bool is_uuid =
      uuid.size() <= kMaxTokenLength && std::ranges::all_of(uuid, [](char c) { return is_hexadecimal(c) || c == '-'; });
  return is_uuid && is_image_version(name.substr(0, at)) ? name.substr(0, at) : std::string_view();
}

}  // namespace

bool is_image_name(std::string_view name) {
  return !name.empty() && name.size() <= kMaxTokenLength && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '-';
  });
}

bool is_image_version(std::string_view version) {
  return !version.empty() && version.size() <= kMaxTokenLength && is_digit(version.front()) &&
         is_digit(version.back()) && version.find("..") == std::string_view::npos &&
         std::ranges::all_of(version, [](char c) { return is_digit(c) || c == '.'; });
}

bool is_newer(std::string_view version, std::string_view than) {
  while (!version.empty() && !than.empty()) {
    const std::string_view a = take_number(&version);
    const std::string_view b = take_number(&than);
    if (a != b) return a.size() != b.size() ? a.size() > b.size() : a > b;
  }
  return !version.empty();
}

Result<UpdateManifest> parse_update_manifest(std::string_view text, std::string_view image) {
  UpdateManifest manifest;
  std::size_t number = 0;
  const auto bad = [&](std::string_view what) {
    return Error(ErrorCode::kBadData, fmt::format("{} line {}: {}; copy the folder that image/build made once more",
                                                  kUpdateSums, number, what));
  };
  if (text.size() > kMaxUpdateTextBytes) return bad("it is too long");
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    at = end + 1;
    ++number;
    if (line.size() < kDigits + 3 || !std::ranges::all_of(line.substr(0, kDigits), is_hexadecimal) ||
        line[kDigits] != ' ' || (line[kDigits + 1] != ' ' && line[kDigits + 1] != '*')) {
      return bad("not a SHA-256, two blanks and a name");
    }
    const std::string_view name = line.substr(kDigits + 2);
    std::size_t kind = 0;
    while (kind < kEnds.size() && version_in(name, image, kind).empty()) ++kind;
    if (kind == kEnds.size()) return bad(fmt::format("'{}' is no part of {}", printable(name, 100), image));
    const std::string_view version = version_in(name, image, kind);
    if (!manifest.version.empty() && manifest.version != version) return bad("another version than before");
    if (!manifest.files[kind].name.empty()) return bad("a second file of that kind");
    manifest.version = version;
    manifest.files[kind] = {std::string(name), std::string(line.substr(0, kDigits))};
  }
  for (std::size_t kind = 0; kind < kEnds.size(); ++kind) {
    if (manifest.files[kind].name.empty()) return bad(fmt::format("it ends without a file '{}'", kEnds[kind]));
  }
  return manifest;
}

}  // namespace cyclorama
