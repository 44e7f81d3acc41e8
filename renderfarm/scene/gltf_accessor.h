// SPDX-License-Identifier: Apache-2.0
/// Typed arrays inside buffers. Source: glTF 2.0, section 3.6.2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_document.h"

namespace cyclorama::scene {

/// The values are glTF's componentType.
enum class GltfComponent : std::uint16_t { kI8 = 5120, kU8 = 5121, kI16 = 5122, kU16 = 5123, kU32 = 5125, kF32 = 5126 };

[[nodiscard]] std::size_t component_bytes(GltfComponent component);

/// A checked accessor: every element is inside `data`, at any alignment. A value; valid as long as the document.
struct GltfAccessor {
  const std::byte* data = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;  ///< Bytes from one element to the next.
  GltfComponent component = GltfComponent::kF32;
  int width = 1;  ///< Components per element: 1 to 4, or 16 for a matrix, column by column.
  bool normalized = false;
  std::string place;
  std::shared_ptr<const std::vector<std::byte>> owned;  ///< Owns `data` if no buffer does; otherwise null.

  [[nodiscard]] bool is_packed_float() const {
    return component == GltfComponent::kF32 && stride == static_cast<std::size_t>(width) * sizeof(float);
  }
};

/// Declared properties of an accessor without its data, which Draco stores elsewhere.
struct GltfAccessorShape {
  std::uint64_t count = 0;
  GltfComponent component = GltfComponent::kF32;
  int width = 1;
  bool normalized = false;
  std::string place;
};

/// read_accessor_shape() and read_accessor() read accessor `index`, which must come from GltfDocument::index().
/// read_accessor() also applies sparse values. Errors: kBadData if a type is wrong, values are outside the buffer view,
/// or the budget is exceeded.
Result<GltfAccessorShape> read_accessor_shape(const GltfDocument& document, std::size_t index);
Result<GltfAccessor> read_accessor(GltfDocument* document, std::size_t index, GltfBudget* budget);
/// Checks that the file has as many elements as the accessor declares, without allocating memory for them.
Status check_accessor(GltfDocument* document, std::size_t index);

/// A selection of elements: all of them, or some in increasing order.
class GltfSelection {
 public:
  static GltfSelection all(std::size_t count) { return {count, {}}; }
  static GltfSelection some(std::vector<std::uint32_t> elements) {
    const std::size_t count = elements.size();
    return {count, std::move(elements)};
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool is_all() const { return elements_.empty(); }
  [[nodiscard]] std::size_t operator[](std::size_t i) const { return is_all() ? i : elements_[i]; }

 private:
  GltfSelection(std::size_t size, std::vector<std::uint32_t> elements) : size_(size), elements_(std::move(elements)) {}
  std::size_t size_;
  std::vector<std::uint32_t> elements_;
};

/// Reads elements as floats; integers are normalised if the accessor requests it. Preconditions: the accessor's width
/// is N, the selection is inside it, and the caller has charged the budget for the result.
template <std::size_t N>
std::vector<std::array<float, N>> read_floats(const GltfAccessor& accessor, const GltfSelection& selection);
extern template std::vector<std::array<float, 1>> read_floats(const GltfAccessor&, const GltfSelection&);
extern template std::vector<std::array<float, 2>> read_floats(const GltfAccessor&, const GltfSelection&);
extern template std::vector<std::array<float, 3>> read_floats(const GltfAccessor&, const GltfSelection&);
extern template std::vector<std::array<float, 4>> read_floats(const GltfAccessor&, const GltfSelection&);
extern template std::vector<std::array<float, 16>> read_floats(const GltfAccessor&, const GltfSelection&);

/// Writes the first `indices.size()` elements to `indices`. Precondition: the accessor has an unsigned component, width
/// 1 and enough elements.
void read_indices(const GltfAccessor& accessor, std::span<std::uint32_t> indices);

}  // namespace cyclorama::scene
