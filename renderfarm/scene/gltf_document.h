// SPDX-License-Identifier: Apache-2.0
/// A .glb or .gltf file: its JSON, its buffers and the references between its lists.
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

namespace cyclorama::scene {

struct GltfBufferView {
  std::span<const std::byte> bytes;
  std::optional<std::uint64_t> stride;  ///< Declared value; nothing if the file declares none.
  std::string place;
};

/// Borrows the bytes from which it was opened; owns the files and data URIs to which they refer, which are opened on
/// first use. Thread-bound.
class GltfDocument {
 public:
  /// Opens a document. Relative references are resolved in `folder`; without it, nothing is read from disk. `context`
  /// must outlive the document. Errors: kBadData if the bytes are not glTF, are damaged, are of another version, or
  /// require an unsupported extension.
  static Result<GltfDocument> open(std::span<const std::byte> bytes, std::optional<std::filesystem::path> folder,
                                   GltfContext* context);
  GltfDocument(GltfDocument&&) noexcept;
  GltfDocument& operator=(GltfDocument&&) noexcept;
  ~GltfDocument();

  [[nodiscard]] const GltfObject& root() const;
  /// Returns true if extensionsUsed contains `extension`.
  [[nodiscard]] bool uses(std::string_view extension) const;

  /// Returns the index into the root's array `list` that `from`.`key` states, after a check of its range; nothing if
  /// the key is absent.
  Result<std::optional<std::size_t>> index(const GltfObject& from, const char* key, const char* list) const;
  Result<std::size_t> required_index(const GltfObject& from, const char* key, const char* list) const;
  /// Returns an item of the root's array `list`. Precondition: `index` came from index().
  Result<GltfObject> item(const char* list, std::size_t index) const;

  /// Returns a buffer view, which is valid as long as the document. Errors: kNotFound, kSystem or kBadData for the file
  /// that contains the data.
  Result<GltfBufferView> buffer_view(std::size_t index);
  /// Returns the content of a "uri", a data URI or a file; it is valid as long as the document.
  Result<std::span<const std::byte>> resource(const GltfObject& from, std::string_view uri);

 private:
  struct State;
  explicit GltfDocument(std::unique_ptr<State> state);
  /// Returns the bytes that `buffer`, `byteOffset` and `byteLength` of `from` select.
  Result<std::span<const std::byte>> part_of_buffer(const GltfObject& from);
  /// Returns a buffer view that EXT_meshopt_compression compressed; it is decoded only once.
  Result<std::span<const std::byte>> decompressed(std::size_t view, const GltfObject& meshopt);
  Result<std::span<const std::byte>> buffer(std::size_t index);
  Result<std::span<const std::byte>> load_buffer(const GltfObject& buffer, std::size_t index);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::scene
