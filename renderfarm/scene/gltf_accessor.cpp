// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include "common/base/check.h"

namespace cyclorama::scene {
namespace {

Result<GltfComponent> read_component(const GltfObject& object) {
  TRY_ASSIGN(const std::uint64_t type, object.required_integer("componentType"));
  switch (type) {
    case 5120:
    case 5121:
    case 5122:
    case 5123:
    case 5125:
    case 5126:
      return static_cast<GltfComponent>(type);
    default:
      return object.damaged("componentType", fmt::format("{} is no component type", type));
  }
}

Result<int> read_width(const GltfObject& accessor) {
  constexpr std::array<std::pair<std::string_view, int>, 5> kWidths = {
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}}};
  TRY_ASSIGN(const std::string type, accessor.text_or("type", ""));
  for (const auto& [name, width] : kWidths) {
    if (type == name) return width;
  }
  return accessor.damaged("type", "SCALAR, VEC2, VEC3, VEC4 or MAT4 is needed here");
}

/// Checks that `count` elements of `element_bytes`, `stride` apart, fit into `view` from `offset` on.
Status check_fit(const GltfObject& object, const GltfBufferView& view, std::uint64_t offset, std::uint64_t count,
                 std::uint64_t element_bytes, std::uint64_t stride) {
  if (count == 0) return Done{};
  const std::uint64_t size = view.bytes.size();
  if (offset > size || element_bytes > size - offset || (count - 1) > (size - offset - element_bytes) / stride) {
    return gltf_damaged(object.place(),
                        fmt::format("{} elements of {} bytes from byte {} do not fit into {} with its {}", count,
                                    element_bytes, offset, view.place, size));
  }
  return Done{};
}

/// Returns the data to which `bufferView` and `byteOffset` of `part` refer. The parts of sparse accessors are always
/// packed.
Result<const std::byte*> packed_data(GltfDocument* document, const GltfObject& part, std::uint64_t count,
                                     std::uint64_t element_bytes) {
  TRY_ASSIGN(const std::size_t index, document->required_index(part, "bufferView", "bufferViews"));
  TRY_ASSIGN(const GltfBufferView view, document->buffer_view(index));
  if (view.stride) return gltf_damaged(view.place, "sparse values are packed, and these have a byteStride");
  TRY_ASSIGN(const std::optional<std::uint64_t> offset, part.integer("byteOffset"));
  TRY(check_fit(part, view, offset.value_or(0), count, element_bytes, element_bytes));
  return view.bytes.data() + offset.value_or(0);
}

template <typename T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

std::uint32_t load_index(const std::byte* from, GltfComponent component) {
  switch (component) {
    case GltfComponent::kU8:
      return load<std::uint8_t>(from);
    case GltfComponent::kU16:
      return load<std::uint16_t>(from);
    default:
      return load<std::uint32_t>(from);
  }
}

/// Replaces some elements of `values`, which has `count` packed elements.
Status apply_sparse(GltfDocument* document, const GltfObject& sparse, std::uint64_t count, std::size_t element_bytes,
                    std::vector<std::byte>* values) {
  TRY_ASSIGN(const std::uint64_t changed, sparse.required_integer("count"));
  if (changed > count) return sparse.damaged("count", fmt::format("{} of {} elements are changed", changed, count));
  TRY_ASSIGN(const std::optional<GltfObject> indices, sparse.object("indices"));
  TRY_ASSIGN(const std::optional<GltfObject> replacements, sparse.object("values"));
  if (!indices || !replacements) return gltf_damaged(sparse.place(), "has no indices or no values");
  TRY_ASSIGN(const GltfComponent component, read_component(*indices));
  if (component != GltfComponent::kU8 && component != GltfComponent::kU16 && component != GltfComponent::kU32) {
    return indices->damaged("componentType", "indices are unsigned integers");
  }
  const std::size_t index_bytes = component_bytes(component);
  TRY_ASSIGN(const std::byte* const where, packed_data(document, *indices, changed, index_bytes));
  TRY_ASSIGN(const std::byte* const what, packed_data(document, *replacements, changed, element_bytes));
  for (std::size_t i = 0; i < changed; ++i) {
    const std::uint32_t index = load_index(where + i * index_bytes, component);
    if (index >= count) return gltf_damaged(indices->place(), fmt::format("index {} of {} elements", index, count));
    std::memcpy(values->data() + index * element_bytes, what + i * element_bytes, element_bytes);
  }
  return Done{};
}

Result<GltfAccessorShape> read_shape(const GltfObject& object) {
  GltfAccessorShape shape;
  TRY_ASSIGN(shape.count, object.required_integer("count"));
  TRY_ASSIGN(shape.component, read_component(object));
  TRY_ASSIGN(shape.width, read_width(object));
  TRY_ASSIGN(const std::optional<bool> normalized, object.flag("normalized"));
  shape.normalized = normalized.value_or(false);
  shape.place = object.place();
  // This importer and Embree count elements in 32 bits.
  if (shape.count > std::numeric_limits<std::uint32_t>::max()) {
    return object.damaged("count", fmt::format("{} elements are more than 32 bits can count", shape.count));
  }
  return shape;
}

/// Returns the accessor with a pointer to its data; the pointer is null if the file omits the data, which are then
/// zeros.
Result<GltfAccessor> locate(GltfDocument* document, const GltfObject& object) {
  constexpr std::uint64_t kMaxZeros = std::uint64_t{1} << 22;
  TRY_ASSIGN(GltfAccessorShape shape, read_shape(object));
  const std::size_t element_bytes = component_bytes(shape.component) * static_cast<std::size_t>(shape.width);
  GltfAccessor accessor;
  accessor.count = shape.count;
  accessor.stride = element_bytes;
  accessor.component = shape.component;
  accessor.width = shape.width;
  accessor.normalized = shape.normalized;
  accessor.place = std::move(shape.place);
  TRY_ASSIGN(const std::optional<std::size_t> view_index, document->index(object, "bufferView", "bufferViews"));
  if (view_index) {
    TRY_ASSIGN(const GltfBufferView view, document->buffer_view(*view_index));
    TRY_ASSIGN(const std::optional<std::uint64_t> offset, object.integer("byteOffset"));
    accessor.stride = view.stride.value_or(element_bytes);
    if (accessor.stride < element_bytes) {
      return gltf_damaged(accessor.place,
                          fmt::format("elements of {} bytes, {} apart", element_bytes, accessor.stride));
    }
    TRY(check_fit(object, view, offset.value_or(0), accessor.count, element_bytes, accessor.stride));
    if (accessor.count > 0) accessor.data = view.bytes.data() + offset.value_or(0);
  } else if (accessor.count > kMaxZeros) {
    return object.damaged("count", fmt::format("{} elements, and no bufferView holds them", accessor.count));
  }
  return accessor;
}

/// Returns packed copies of `accessor`'s elements, or zeros if it has no data; sparse values may be applied to them.
Result<std::vector<std::byte>> packed_copy(const GltfAccessor& accessor, std::size_t element_bytes,
                                           GltfBudget* budget) {
  TRY(budget->take(accessor.place, accessor.count, element_bytes));
  std::vector<std::byte> values(accessor.count * element_bytes);
  for (std::size_t i = 0; accessor.data != nullptr && i < accessor.count; ++i) {
    std::memcpy(values.data() + i * element_bytes, accessor.data + i * accessor.stride, element_bytes);
  }
  return values;
}

template <typename T>
float as_float(T value, [[maybe_unused]] bool normalized) {
  const auto number = static_cast<float>(value);
  if constexpr (std::is_floating_point_v<T>) {
    return number;
  } else {
    if (!normalized) return number;
    const float scaled = number / static_cast<float>(std::numeric_limits<T>::max());
    return std::is_signed_v<T> ? std::max(scaled, -1.0f) : scaled;
  }
}

template <std::size_t N, typename T>
void convert(const GltfAccessor& accessor, const GltfSelection& selection,
             std::vector<std::array<float, N>>* ret_values) {
  for (std::size_t i = 0; i < selection.size(); ++i) {
    const std::byte* const element = accessor.data + selection[i] * accessor.stride;
    for (std::size_t k = 0; k < N; ++k) {
      (*ret_values)[i][k] = as_float(load<T>(element + k * sizeof(T)), accessor.normalized);
    }
  }
}

template <typename T>
void widen(const GltfAccessor& accessor, std::span<std::uint32_t> indices) {
  const std::byte* element = accessor.data;
  for (std::uint32_t& index : indices) {
    index = std::uint32_t{load<T>(element)};
    element += accessor.stride;
  }
}

}  // namespace

std::size_t component_bytes(GltfComponent component) {
  switch (component) {
    case GltfComponent::kI8:
    case GltfComponent::kU8:
      return 1;
    case GltfComponent::kI16:
    case GltfComponent::kU16:
      return 2;
    case GltfComponent::kU32:
    case GltfComponent::kF32:
      return 4;
  }
  return 4;
}

Result<GltfAccessorShape> read_accessor_shape(const GltfDocument& document, std::size_t index) {
  TRY_ASSIGN(const GltfObject object, document.item("accessors", index));
  return read_shape(object);
}

Status check_accessor(GltfDocument* document, std::size_t index) {
  TRY_ASSIGN(const GltfObject object, document->item("accessors", index));
  TRY(locate(document, object));
  return Done{};
}

Result<GltfAccessor> read_accessor(GltfDocument* document, std::size_t index, GltfBudget* budget) {
  TRY_ASSIGN(const GltfObject object, document->item("accessors", index));
  TRY_ASSIGN(GltfAccessor accessor, locate(document, object));
  const std::size_t element_bytes = component_bytes(accessor.component) * static_cast<std::size_t>(accessor.width);
  TRY_ASSIGN(const std::optional<GltfObject> sparse, object.object("sparse"));
  if (sparse || (accessor.data == nullptr && accessor.count > 0)) {
    TRY_ASSIGN(std::vector<std::byte> values, packed_copy(accessor, element_bytes, budget));
    if (sparse) TRY(apply_sparse(document, *sparse, accessor.count, element_bytes, &values));
    accessor.owned = std::make_shared<const std::vector<std::byte>>(std::move(values));
    accessor.data = accessor.owned->data();
    accessor.stride = element_bytes;
  }
  return accessor;
}

template <std::size_t N>
std::vector<std::array<float, N>> read_floats(const GltfAccessor& accessor, const GltfSelection& selection) {
  CHECK(accessor.width == static_cast<int>(N));
  std::vector<std::array<float, N>> values(selection.size());
  if (values.empty()) return values;
  if (accessor.is_packed_float() && selection.is_all()) {
    std::memcpy(values.data(), accessor.data, values.size() * sizeof values[0]);
    return values;
  }
  switch (accessor.component) {
    case GltfComponent::kI8:
      convert<N, std::int8_t>(accessor, selection, &values);
      break;
    case GltfComponent::kU8:
      convert<N, std::uint8_t>(accessor, selection, &values);
      break;
    case GltfComponent::kI16:
      convert<N, std::int16_t>(accessor, selection, &values);
      break;
    case GltfComponent::kU16:
      convert<N, std::uint16_t>(accessor, selection, &values);
      break;
    case GltfComponent::kU32:
      convert<N, std::uint32_t>(accessor, selection, &values);
      break;
    case GltfComponent::kF32:
      convert<N, float>(accessor, selection, &values);
      break;
  }
  return values;
}
template std::vector<std::array<float, 1>> read_floats(const GltfAccessor&, const GltfSelection&);
template std::vector<std::array<float, 2>> read_floats(const GltfAccessor&, const GltfSelection&);
template std::vector<std::array<float, 3>> read_floats(const GltfAccessor&, const GltfSelection&);
template std::vector<std::array<float, 4>> read_floats(const GltfAccessor&, const GltfSelection&);
template std::vector<std::array<float, 16>> read_floats(const GltfAccessor&, const GltfSelection&);

void read_indices(const GltfAccessor& accessor, std::span<std::uint32_t> indices) {
  CHECK(accessor.width == 1 && indices.size() <= accessor.count);
  switch (accessor.component) {
    case GltfComponent::kU8:
      return widen<std::uint8_t>(accessor, indices);
    case GltfComponent::kU16:
      return widen<std::uint16_t>(accessor, indices);
    case GltfComponent::kU32:
      return widen<std::uint32_t>(accessor, indices);
    default:
      CHECK(false);
  }
}

}  // namespace cyclorama::scene
