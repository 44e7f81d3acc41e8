// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_container.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "renderfarm/scene/gltf_json.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinaryChunk = 0x004e4942;

// glTF itself nests about ten levels, but "extras" may contain anything.
constexpr std::size_t kDeepestJson = 256;
// Size of a node of the JSON tree: its value, its share of an array or map, and the allocator's overhead.
constexpr std::size_t kBytesPerJsonValue = 96;

Error damaged(std::string_view what) {
  return Error(ErrorCode::kBadData, fmt::format("{}; the file is damaged, copy or export it again", what));
}

std::uint32_t read_u32(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Returns true if the file ends at `at`, or if a binary chunk that fits into the file begins there.
bool continues_at(std::span<const std::byte> bytes, std::size_t at) {
  if (at == bytes.size()) return true;
  return at < bytes.size() && bytes.size() - at >= kChunkHeaderBytes && read_u32(bytes, at + 4) == kBinaryChunk &&
         read_u32(bytes, at) <= bytes.size() - at - kChunkHeaderBytes;
}

/// Returns the end of the chunk whose content ends at `end`. Of the writers that state a length which is not a multiple
/// of 4, some pad the chunk and others do not. Returns nothing if neither or both are possible.
std::optional<std::size_t> end_of_chunk(std::span<const std::byte> bytes, std::size_t end) {
  const std::size_t padded = (end + 3) / 4 * 4;
  if (padded == end) return end;
  const bool goes_on_unpadded = continues_at(bytes, end);
  if (goes_on_unpadded == continues_at(bytes, padded)) return std::nullopt;
  return goes_on_unpadded ? end : padded;
}

Result<GltfChunks> split_binary(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes) return damaged("the binary glTF ends within its header");
  const std::uint32_t version = read_u32(bytes, 4);
  if (version != 2) {
    return Error(ErrorCode::kBadData, fmt::format("binary glTF version {}; export the scene as glTF 2.0", version));
  }
  const std::uint32_t length = read_u32(bytes, 8);
  if (length > bytes.size()) {
    return damaged(fmt::format("the file is cut short: it has {} of {} bytes", bytes.size(), length));
  }
  GltfChunks chunks;
  bool has_json = false;
  std::size_t number = 0;
  for (std::size_t at = kHeaderBytes; at < length; ++number) {
    if (length - at < kChunkHeaderBytes) return damaged(fmt::format("chunk {} ends within its header", number));
    const std::uint32_t size = read_u32(bytes, at);
    const std::uint32_t type = read_u32(bytes, at + 4);
    at += kChunkHeaderBytes;
    if (size > length - at)
      return damaged(fmt::format("chunk {} extends beyond the length that the header states", number));
    const std::span<const std::byte> content = bytes.subspan(at, size);
    chunks.has_unpadded_chunk |= size % 4 != 0;
    const std::optional<std::size_t> next = end_of_chunk(bytes.first(length), at + size);
    if (!next) return damaged(fmt::format("chunk {} has {} bytes, not a multiple of 4", number, size));
    at = *next;
    if (number == 0 && type != kJsonChunk) return damaged("the first chunk is not JSON");
    if (type == kJsonChunk) {
      if (has_json) return damaged("there are two JSON chunks");
      has_json = true;
      chunks.json = {reinterpret_cast<const char*>(content.data()), content.size()};
    } else if (type == kBinaryChunk) {
      if (number != 1) return damaged("a binary chunk is not the second chunk");
      chunks.binary = content;
    }
  }
  if (!has_json) return damaged("there is no JSON chunk");
  return chunks;
}

// Charges the budget for the tree that the parser would build, before it is built.
Status check_json_shape(std::string_view text, GltfBudget* budget) {
  std::size_t depth = 0;
  std::size_t values = 1;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        in_string = false;
      }
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      ++values;
      if (++depth > kDeepestJson) return damaged(fmt::format("the JSON is nested over {} deep", kDeepestJson));
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    } else if (c == ',') {
      ++values;
    }
  }
  TRY(budget->take("the JSON", values, kBytesPerJsonValue));
  return budget->take("the JSON", text.size(), 1);
}

}  // namespace

Result<GltfChunks> split_gltf(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.empty()) return damaged("the file is empty");
  if (text.substr(0, 4) == "glTF") return split_binary(bytes);
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  const std::size_t start = text.substr(0, kByteOrderMark.size()) == kByteOrderMark ? kByteOrderMark.size() : 0;
  const std::size_t first = text.find_first_not_of(" \t\r\n", start);
  if (first == std::string_view::npos || text[first] != '{') {
    return Error(ErrorCode::kBadData, "this is not glTF: it starts neither with 'glTF' nor with '{'; export it again");
  }
  return GltfChunks{text, std::nullopt};
}

Status parse_gltf_json(std::string_view text, GltfBudget* budget, nlohmann::json* ret_root) {
  TRY(check_json_shape(text, budget));
  try {
    *ret_root = nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& e) {
    constexpr std::size_t kMaxReasonBytes = 200;
    std::string_view reason = e.what();
    // The library's prefix, "[json.exception.parse_error.101] ", does not help users.
    if (const std::size_t prefix = reason.find("] "); prefix != std::string_view::npos)
      reason.remove_prefix(prefix + 2);
    return damaged(fmt::format("the JSON cannot be read: {}", printable(reason, kMaxReasonBytes)));
  }
  return Done{};
}

}  // namespace cyclorama::scene
