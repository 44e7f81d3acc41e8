// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_draco.h"

#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <limits>
#include <string>

#include "common/base/text.h"

namespace cyclorama::scene {
namespace {

// The only bitstream version that the extension allows.
constexpr int kBitstreamMajor = 2;
constexpr int kBitstreamMinor = 2;
constexpr std::uint16_t kBitstream = DRACO_BITSTREAM_VERSION(kBitstreamMajor, kBitstreamMinor);
// libdraco 1.5.5 was measured to need 45 temporary bytes for each triangle of a scanned cave (595,000 triangles,
// positions only). More than twice as much leaves room for other attributes.
constexpr std::size_t kWorkBytesPerTriangle = 120;

struct AnnouncedSize {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  // With Edgebreaker, before vertices on seams are split.
  bool vertices_are_final = false;
};

/// Reads only the sizes. Source: Draco bitstream specification 2.2, sections 4 and 5.
std::optional<AnnouncedSize> announced_size(std::span<const std::byte> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::array<char, 5> magic{};
  std::uint8_t major = 0;
  std::uint8_t minor = 0;
  std::uint8_t type = 0;
  std::uint8_t method = 0;
  std::uint16_t flags = 0;
  if (!buffer.Decode(magic.data(), magic.size()) || std::memcmp(magic.data(), "DRACO", magic.size()) != 0 ||
      !buffer.Decode(&major) || !buffer.Decode(&minor) || !buffer.Decode(&type) || !buffer.Decode(&method) ||
      !buffer.Decode(&flags) || major != kBitstreamMajor || minor != kBitstreamMinor ||
      type != draco::TRIANGULAR_MESH || method > draco::MESH_EDGEBREAKER_ENCODING) {
    return std::nullopt;
  }
  buffer.set_bitstream_version(kBitstream);
  draco::GeometryMetadata metadata;
  if ((flags & METADATA_FLAG_MASK) != 0 && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) {
    return std::nullopt;
  }
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  if (method == draco::MESH_SEQUENTIAL_ENCODING) {
    if (!draco::DecodeVarint(&first, &buffer) || !draco::DecodeVarint(&second, &buffer)) return std::nullopt;
    return AnnouncedSize{first, second, true};
  }
  std::uint8_t traversal = 0;
  if (!buffer.Decode(&traversal) || !draco::DecodeVarint(&first, &buffer) || !draco::DecodeVarint(&second, &buffer)) {
    return std::nullopt;
  }
  return AnnouncedSize{second, first, false};
}

std::optional<GltfComponent> component_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return GltfComponent::kI8;
    case draco::DT_UINT8:
      return GltfComponent::kU8;
    case draco::DT_INT16:
      return GltfComponent::kI16;
    case draco::DT_UINT16:
      return GltfComponent::kU16;
    case draco::DT_UINT32:
      return GltfComponent::kU32;
    case draco::DT_FLOAT32:
      return GltfComponent::kF32;
    default:
      return std::nullopt;
  }
}

}  // namespace

struct GltfDracoMesh::State {
  std::unique_ptr<draco::Mesh> mesh;
  GltfObject attributes;
};

GltfDracoMesh::GltfDracoMesh(std::unique_ptr<State> state) : state_(std::move(state)) {}
GltfDracoMesh::GltfDracoMesh(GltfDracoMesh&&) noexcept = default;
GltfDracoMesh& GltfDracoMesh::operator=(GltfDracoMesh&&) noexcept = default;
GltfDracoMesh::~GltfDracoMesh() = default;

Result<GltfDracoMesh> GltfDracoMesh::decode(GltfDocument* document, const GltfObject& extension,
                                            const GltfDracoPromise& promise, GltfBudget* budget) {
  TRY_ASSIGN(std::optional<GltfObject> attributes, extension.object("attributes"));
  if (!attributes) return extension.damaged("attributes", "is missing");
  TRY_ASSIGN(const std::size_t view_index, document->required_index(extension, "bufferView", "bufferViews"));
  TRY_ASSIGN(const GltfBufferView view, document->buffer_view(view_index));
  const std::optional<AnnouncedSize> announced = announced_size(view.bytes);
  if (!announced) return gltf_damaged(extension.place(), "the data is not a Draco 2.2 mesh");
  if (announced->triangles != promise.triangles ||
      (announced->vertices_are_final && announced->vertices != promise.vertices)) {
    return gltf_damaged(extension.place(),
                        fmt::format("the Draco data has {} triangles and {} vertices where the accessors say {} and {}",
                                    announced->triangles, announced->vertices, promise.triangles, promise.vertices));
  }
  TRY(budget->take(extension.place(), promise.triangles, kWorkBytesPerTriangle));
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(view.bytes.data()), view.bytes.size());
  draco::Decoder decoder;
  draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
  budget->give_back(promise.triangles, kWorkBytesPerTriangle);
  if (!decoded.ok()) {
    return gltf_damaged(extension.place(), fmt::format("the Draco data cannot be decoded: {}",
                                                       printable(decoded.status().error_msg_string())));
  }
  auto state = std::make_unique<State>(State{std::move(decoded).value(), *std::move(attributes)});
  const draco::Mesh& mesh = *state->mesh;
  if (mesh.num_faces() != promise.triangles || mesh.num_points() != promise.vertices) {
    return gltf_damaged(extension.place(),
                        fmt::format("the Draco data has {} triangles and {} vertices where the accessors say {} and {}",
                                    mesh.num_faces(), mesh.num_points(), promise.triangles, promise.vertices));
  }
  return GltfDracoMesh(std::move(state));
}

GltfTriangles GltfDracoMesh::triangles() const {
  const draco::Mesh& mesh = *state_->mesh;
  GltfTriangles triangles(mesh.num_faces());
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
    triangles[i] = {face[0].value(), face[1].value(), face[2].value()};
  }
  return triangles;
}

Result<std::optional<GltfAccessor>> GltfDracoMesh::attribute(const char* semantic, const GltfAccessorShape& shape,
                                                             GltfBudget* budget) const {
  const GltfObject& ids = state_->attributes;
  TRY_ASSIGN(const std::optional<std::uint64_t> id, ids.integer(semantic));
  if (!id) return std::optional<GltfAccessor>();
  const draco::Mesh& mesh = *state_->mesh;
  const bool fits = *id <= std::numeric_limits<std::uint32_t>::max();
  const draco::PointAttribute* const source =
      fits ? mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(*id)) : nullptr;
  if (source == nullptr) return ids.damaged(semantic, fmt::format("the Draco data has no attribute {}", *id));
  const std::optional<GltfComponent> component = component_of(source->data_type());
  if (!component || source->num_components() != shape.width || shape.count != mesh.num_points()) {
    return ids.damaged(semantic, "the Draco data has another type or count than the accessor");
  }
  const std::size_t bytes = component_bytes(*component) * static_cast<std::size_t>(shape.width);
  TRY(budget->take(shape.place, shape.count, bytes));
  auto values = std::make_shared<std::vector<std::byte>>(shape.count * bytes);
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex entry = source->mapped_index(draco::PointIndex(i));
    if (entry.value() >= source->size()) return ids.damaged(semantic, "the Draco data points outside itself");
    std::memcpy(values->data() + i * bytes, source->GetAddress(entry), bytes);
  }
  GltfAccessor accessor;
  accessor.count = shape.count;
  accessor.stride = bytes;
  accessor.component = *component;
  accessor.width = shape.width;
  accessor.normalized = shape.normalized;
  accessor.place = shape.place;
  accessor.data = values->data();
  accessor.owned = std::move(values);
  return std::optional(std::move(accessor));
}

}  // namespace cyclorama::scene
