// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "common/base/text.h"
#include "renderfarm/scene/gltf_meshopt_attributes.h"

namespace cyclorama::scene {
namespace {

/// The library asserts this limit, so it is checked before the library is called.
constexpr std::uint64_t kMaxVertexBytes = 256;
/// Version 0 of the attribute stream needs at least 2 bits for 16 equal bytes, version 1 for 256.
constexpr std::uint64_t kMaxExpansion = 64;
constexpr std::uint64_t kMaxExpansionV1 = 1024;

struct Layout {
  std::string mode;
  std::string filter;
  std::uint64_t count = 0;
  std::uint64_t stride = 0;
};

Result<Layout> read_layout(const GltfObject& extension) {
  Layout layout;
  TRY_ASSIGN(const std::optional<std::string> mode, extension.text("mode"));
  if (!mode) return extension.damaged("mode", "is missing");
  layout.mode = *mode;
  TRY_ASSIGN(layout.filter, extension.text_or("filter", "NONE"));
  TRY_ASSIGN(layout.count, extension.required_integer("count"));
  TRY_ASSIGN(layout.stride, extension.required_integer("byteStride"));
  return layout;
}

Status check_filter(const GltfObject& extension, const Layout& layout) {
  const std::uint64_t stride = layout.stride;
  const bool takes_4_or_8 = layout.filter == "OCTAHEDRAL" || layout.filter == "COLOR";
  const bool fits = layout.filter == "NONE" || (takes_4_or_8 && (stride == 4 || stride == 8)) ||
                    (layout.filter == "QUATERNION" && stride == 8) || layout.filter == "EXPONENTIAL";
  if (fits && (layout.filter == "NONE" || layout.mode == "ATTRIBUTES")) return Done{};
  return extension.damaged("filter", fmt::format("{} does not go with {} of {} bytes", printable(layout.filter),
                                                 printable(layout.mode), stride));
}

Status check_stride(const GltfObject& extension, const Layout& layout) {
  if (layout.mode == "ATTRIBUTES") {
    if (layout.stride >= 4 && layout.stride <= kMaxVertexBytes && layout.stride % 4 == 0) return Done{};
    return extension.damaged("byteStride",
                             fmt::format("{} is no multiple of 4 up to {}", layout.stride, kMaxVertexBytes));
  }
  if (layout.mode != "TRIANGLES" && layout.mode != "INDICES") {
    return extension.damaged("mode", fmt::format("{} is no mode of compression", printable(layout.mode)));
  }
  if (layout.stride != 2 && layout.stride != 4) {
    return extension.damaged("byteStride", fmt::format("indices have 2 or 4 bytes, not {}", layout.stride));
  }
  if (layout.mode == "INDICES" || layout.count % 3 == 0) return Done{};
  return extension.damaged("count", fmt::format("{} corners are no whole triangles", layout.count));
}

Status check_count(const GltfObject& extension, const Layout& layout, std::span<const std::byte> stored) {
  const std::size_t stored_bytes = stored.size();
  const std::uint64_t expansion = is_meshopt_attributes_v1(stored) ? kMaxExpansionV1 : kMaxExpansion;
  // Each triangle takes at least one byte, as does each index of a sequence.
  std::uint64_t max_count = stored_bytes * expansion / layout.stride;
  if (layout.mode == "TRIANGLES") max_count = std::uint64_t{3} * stored_bytes;
  if (layout.mode == "INDICES") max_count = stored_bytes;
  if (layout.count <= max_count) return Done{};
  return extension.damaged("count",
                           fmt::format("{} elements cannot be stored in {} bytes", layout.count, stored_bytes));
}

/// Returns false for damaged data.
bool decode(const Layout& layout, std::span<const std::byte> stored, std::vector<std::byte>* ret_bytes) {
  const auto* const from = reinterpret_cast<const unsigned char*>(stored.data());
  const auto count = static_cast<std::size_t>(layout.count);
  const auto stride = static_cast<std::size_t>(layout.stride);
  if (layout.mode == "ATTRIBUTES" && is_meshopt_attributes_v1(stored)) {
    std::optional<std::vector<std::byte>> bytes = decode_meshopt_attributes_v1(stored, count, stride);
    if (bytes) *ret_bytes = std::move(*bytes);
    return bytes.has_value();
  }
  ret_bytes->resize(count * stride);
  if (layout.mode == "TRIANGLES") {
    return meshopt_decodeIndexBuffer(ret_bytes->data(), count, stride, from, stored.size()) == 0;
  }
  if (layout.mode == "INDICES") {
    return meshopt_decodeIndexSequence(ret_bytes->data(), count, stride, from, stored.size()) == 0;
  }
  return meshopt_decodeVertexBuffer(ret_bytes->data(), count, stride, from, stored.size()) == 0;
}

void apply_filter(const Layout& layout, std::vector<std::byte>* bytes) {
  const auto count = static_cast<std::size_t>(layout.count);
  const auto stride = static_cast<std::size_t>(layout.stride);
  if (layout.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes->data(), count, stride);
  if (layout.filter == "QUATERNION") meshopt_decodeFilterQuat(bytes->data(), count, stride);
  if (layout.filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes->data(), count, stride);
  if (layout.filter == "COLOR") apply_meshopt_colour_filter(stride, *bytes);
}

}  // namespace

Result<std::vector<std::byte>> decode_meshopt(const GltfObject& extension, std::span<const std::byte> stored,
                                              GltfBudget* budget) {
  TRY_ASSIGN(const Layout layout, read_layout(extension));
  TRY(check_stride(extension, layout));
  TRY(check_filter(extension, layout));
  TRY(check_count(extension, layout, stored));
  TRY(budget->take(extension.place(), layout.count, static_cast<std::size_t>(layout.stride)));
  std::vector<std::byte> bytes;
  if (layout.count == 0) return bytes;
  if (!decode(layout, stored, &bytes)) {
    return gltf_damaged(extension.place(), "the compressed data cannot be decoded");
  }
  apply_filter(layout, &bytes);
  return bytes;
}

}  // namespace cyclorama::scene
