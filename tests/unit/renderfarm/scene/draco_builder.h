// SPDX-License-Identifier: Apache-2.0
/// Builds Draco data for tests.
#pragma once

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/base/check.h"
#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {

inline constexpr int kDracoSide = 12;
inline constexpr int kDracoTriangles = 2 * kDracoSide * kDracoSide;

/// Returns a compressed bumpy square with colours.
inline std::vector<std::uint8_t> compressed_square(int method) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(kDracoTriangles);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int colour = builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
  const auto corner = [](int x, int y) {
    return std::array<float, 3>{static_cast<float>(x), static_cast<float>(y), static_cast<float>(x * y % 3)};
  };
  const auto tint = [](int x, int y) {
    return std::array<std::uint8_t, 4>{static_cast<std::uint8_t>(x * 20), static_cast<std::uint8_t>(y * 20), 0, 255};
  };
  std::uint32_t face = 0;
  const auto add = [&](std::array<int, 2> a, std::array<int, 2> b, std::array<int, 2> c) {
    const draco::FaceIndex index(face++);
    builder.SetAttributeValuesForFace(position, index, corner(a[0], a[1]).data(), corner(b[0], b[1]).data(),
                                      corner(c[0], c[1]).data());
    builder.SetAttributeValuesForFace(colour, index, tint(a[0], a[1]).data(), tint(b[0], b[1]).data(),
                                      tint(c[0], c[1]).data());
  };
  for (int y = 0; y < kDracoSide; ++y) {
    for (int x = 0; x < kDracoSide; ++x) {
      add({x, y}, {x + 1, y}, {x + 1, y + 1});
      add({x, y}, {x + 1, y + 1}, {x, y + 1});
    }
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  draco::EncoderBuffer buffer;
  CHECK(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

/// Returns a file that shows `data`, declared as the result of compressed_square().
inline GltfBuilder draco_file(const std::vector<std::uint8_t>& data) {
  GltfBuilder file;
  const int view = file.add_view(data);
  const int vertices = (kDracoSide + 1) * (kDracoSide + 1);
  file.json["accessors"] = {{{"componentType", 5125}, {"count", kDracoTriangles * 3}, {"type", "SCALAR"}},
                            {{"componentType", 5126}, {"count", vertices}, {"type", "VEC3"}},
                            {{"componentType", 5121}, {"count", vertices}, {"type", "VEC4"}, {"normalized", true}}};
  nlohmann::json& primitive = file.add_primitive({{"POSITION", 1}, {"COLOR_0", 2}});
  primitive["indices"] = 0;
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view},
                                                           {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}};
  file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  file.show();
  return file;
}

}  // namespace cyclorama::scene
