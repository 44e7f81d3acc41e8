// SPDX-License-Identifier: Apache-2.0
/// A glTF file of one square, compressed by meshoptimizer.
#pragma once

#include <meshoptimizer.h>

#include <array>
#include <cstdint>
#include <vector>

#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {

/// Bytes of a compressed vertex buffer and index buffer of a square of two triangles.
struct MeshoptSquare {
  std::vector<std::uint8_t> positions;
  std::vector<std::uint8_t> indices;
};

inline MeshoptSquare compressed_meshopt_square() {
  const std::array<std::array<float, 3>, 4> corners = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  const std::array<std::uint32_t, 6> indices = {0, 1, 2, 2, 3, 0};
  meshopt_encodeVertexVersion(0);
  meshopt_encodeIndexVersion(1);
  MeshoptSquare square;
  square.positions.resize(meshopt_encodeVertexBufferBound(corners.size(), sizeof corners[0]));
  square.positions.resize(meshopt_encodeVertexBuffer(square.positions.data(), square.positions.size(), corners.data(),
                                                     corners.size(), sizeof corners[0]));
  square.indices.resize(meshopt_encodeIndexBufferBound(indices.size(), corners.size()));
  square.indices.resize(
      meshopt_encodeIndexBuffer(square.indices.data(), square.indices.size(), indices.data(), indices.size()));
  return square;
}

/// Returns the file; tests may change its buffer views' extensions.
inline GltfBuilder meshopt_file(const MeshoptSquare& square) {
  GltfBuilder file;
  file.json["extensionsUsed"] = {"EXT_meshopt_compression"};
  file.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  const auto add = [&](const std::vector<std::uint8_t>& stored, const char* mode, std::size_t count,
                       std::size_t stride) {
    const int view = file.add_view(stored);
    nlohmann::json& object = file.json["bufferViews"][static_cast<std::size_t>(view)];
    nlohmann::json extension = object;
    extension.update({{"mode", mode}, {"count", count}, {"byteStride", stride}});
    object = {{"buffer", 1}, {"byteLength", count * stride}};
    object["extensions"]["EXT_meshopt_compression"] = extension;
  };
  add(square.positions, "ATTRIBUTES", 4, 12);
  add(square.indices, "TRIANGLES", 6, 4);
  // The second buffer has no data: it only gives the decoded views a place.
  file.json["buffers"] = {{{"byteLength", file.binary.size()}}, {{"byteLength", 72}}};
  file.json["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                            {{"bufferView", 1}, {"componentType", 5125}, {"count", 6}, {"type", "SCALAR"}}};
  file.add_primitive({{"POSITION", 0}})["indices"] = 1;
  file.show();
  return file;
}

}  // namespace cyclorama::scene
