// SPDX-License-Identifier: Apache-2.0
/// Builds small glTF files for tests.
#pragma once

#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "renderfarm/scene/gltf_import.h"

namespace cyclorama::scene {

/// Starts as a valid empty file; tests may change `json` as needed.
struct GltfBuilder {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::vector<std::byte> binary;

  /// Returns the index of a new buffer view over a copy of `values`, 4-aligned.
  template <typename T>
  int add_view(const std::vector<T>& values) {
    binary.resize((binary.size() + 3) / 4 * 4);
    const std::size_t offset = binary.size();
    const std::size_t size = values.size() * sizeof(T);
    binary.resize(offset + size);
    if (size > 0) std::memcpy(binary.data() + offset, values.data(), size);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  /// Returns the index of a new accessor. `type` is "SCALAR", "VEC3", ...; `component` is glTF's number.
  template <typename T>
  int add_accessor(const std::vector<T>& values, const std::string& type, int component, bool normalized = false) {
    const int width = type == "SCALAR" ? 1 : type.back() - '0';
    nlohmann::json accessor = {{"bufferView", add_view(values)},
                               {"componentType", component},
                               {"count", values.size() / static_cast<std::size_t>(width)},
                               {"type", type}};
    if (normalized) accessor["normalized"] = true;
    json["accessors"].push_back(accessor);
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int add_floats(const std::vector<float>& values, const std::string& type) { return add_accessor(values, type, 5126); }
  int add_indices(const std::vector<std::uint16_t>& values) { return add_accessor(values, "SCALAR", 5123); }

  /// Appends a primitive to the last mesh; creates the first mesh if there is none.
  nlohmann::json& add_primitive(const nlohmann::json& attributes) {
    if (!json.contains("meshes")) json["meshes"].push_back({{"primitives", nlohmann::json::array()}});
    json["meshes"].back()["primitives"].push_back({{"attributes", attributes}});
    return json["meshes"].back()["primitives"].back();
  }
  /// Adds a node with mesh 0 to scene 0.
  void show() {
    json["nodes"].push_back({{"mesh", 0}});
    json["scenes"] = {{{"nodes", {0}}}};
  }

  [[nodiscard]] std::vector<std::byte> glb() const {
    nlohmann::json whole = json;
    if (!binary.empty() && !whole.contains("buffers")) whole["buffers"] = {{{"byteLength", binary.size()}}};
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<std::byte> padded = binary;
    padded.resize((padded.size() + 3) / 4 * 4);
    std::vector<std::byte> file;
    const auto put = [&](std::uint32_t value) {
      const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
      file.insert(file.end(), bytes, bytes + sizeof value);
    };
    const std::size_t size = 12 + 8 + text.size() + (padded.empty() ? 0 : 8 + padded.size());
    put(0x46546c67);
    put(2);
    put(static_cast<std::uint32_t>(size));
    put(static_cast<std::uint32_t>(text.size()));
    put(0x4e4f534a);
    for (const char c : text) file.push_back(static_cast<std::byte>(c));
    if (padded.empty()) return file;
    put(static_cast<std::uint32_t>(padded.size()));
    put(0x004e4942);
    file.insert(file.end(), padded.begin(), padded.end());
    return file;
  }
  [[nodiscard]] Result<Model> import(const ImportLimits& limits = {}) const {
    return import_gltf_bytes(glb(), std::nullopt, limits);
  }
};

/// A right triangle in the xy plane, shown once.
inline GltfBuilder one_triangle() {
  GltfBuilder file;
  file.add_primitive({{"POSITION", file.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")}});
  file.show();
  return file;
}

/// The message of an import that must fail, or "loaded".
inline std::string error_of(const Result<Model>& model) { return model ? "loaded" : model.error().message(); }

}  // namespace cyclorama::scene
