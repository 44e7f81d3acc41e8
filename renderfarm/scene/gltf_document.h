// SPDX-License-Identifier: Apache-2.0
/// The container: .glb or .gltf, its JSON, its buffers and the references between its lists.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_json.h"

namespace cyclorama {

struct GltfBufferView {
  std::span<const std::byte> bytes;
  std::optional<std::uint64_t> stride;  ///< As declared.
  std::string place;
};

/// Borrows the bytes that it was opened on; owns the files and data URIs that they refer to, which are opened when
/// first needed. Thread-bound.
class GltfDocument {
 public:
  /// `folder` is where relative references start; nothing is read from disk without it. `context` must outlive the
  /// document. kBadData  not glTF, damaged, another version, or an extension is required that we lack.
  static Result<GltfDocument> open(std::span<const std::byte> bytes, std::optional<std::filesystem::path> folder,
                                   GltfContext* context);
  GltfDocument(GltfDocument&&) noexcept;
  GltfDocument& operator=(GltfDocument&&) noexcept;
  ~GltfDocument();

  [[nodiscard]] const GltfObject& root() const;
  /// Whether extensionsUsed names it.
  [[nodiscard]] bool uses(std::string_view extension) const;

  /// The index that `from`.`key` holds into the root's array `list`, checked; nothing when the key is absent.
  Result<std::optional<std::size_t>> index(const GltfObject& from, const char* key, const char* list) const;
  Result<std::size_t> required_index(const GltfObject& from, const char* key, const char* list) const;
  /// Precondition: `index` came from index().
  Result<GltfObject> item(const char* list, std::size_t index) const;

  /// kNotFound, kSystem, kBadData  as the file that holds the data. Valid as long as the document.
  Result<GltfBufferView> buffer_view(std::size_t index);
  /// What a "uri" holds: of a data URI or a file. Valid as long as the document.
  Result<std::span<const std::byte>> resource(const GltfObject& from, std::string_view uri);

 private:
  struct State;
  explicit GltfDocument(std::unique_ptr<State> state);
  Result<std::span<const std::byte>> buffer(std::size_t index);
  Result<std::span<const std::byte>> load_buffer(const GltfObject& buffer, std::size_t index);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama
