// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_document.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "common/base/file.h"
#include "common/base/text.h"
#include "renderfarm/scene/gltf_container.h"
#include "renderfarm/scene/gltf_extensions.h"
#include "renderfarm/scene/gltf_meshopt.h"
#include "renderfarm/scene/gltf_uri.h"

namespace cyclorama::scene {
namespace {

Status check_version(const GltfObject& root) {
  TRY_ASSIGN(const std::optional<GltfObject> asset, root.object("asset"));
  if (!asset) return root.damaged("asset", "is missing");
  TRY_ASSIGN(const std::optional<std::string> version, asset->text("version"));
  if (!version) return asset->damaged("version", "is missing");
  TRY_ASSIGN(const std::optional<std::string> min, asset->text("minVersion"));
  // A later 2.x may be read as 2.0, unless minVersion forbids it.
  if (version->substr(0, 2) != "2." || (min && *min != "2.0")) {
    return Error(ErrorCode::kBadData, fmt::format("{}/version: this is glTF '{}'; export the scene as glTF 2.0",
                                                  asset->place(), printable(min ? *min : *version)));
  }
  return Done{};
}

}  // namespace

struct GltfDocument::State {
  nlohmann::json json;
  std::optional<GltfObject> root;
  std::set<std::string, std::less<>> extensions;
  std::optional<std::span<const std::byte>> binary_chunk;
  std::optional<std::filesystem::path> folder;
  GltfContext* context = nullptr;
  std::vector<std::optional<std::span<const std::byte>>> buffers;
  std::vector<MappedFile> files;
  std::set<std::filesystem::path> earned;
  std::vector<std::vector<std::byte>> decoded;
  std::map<std::size_t, std::vector<std::byte>> decompressed;  ///< Keyed by buffer view.
};

GltfDocument::GltfDocument(std::unique_ptr<State> state) : state_(std::move(state)) {}
GltfDocument::GltfDocument(GltfDocument&&) noexcept = default;
GltfDocument& GltfDocument::operator=(GltfDocument&&) noexcept = default;
GltfDocument::~GltfDocument() = default;

Result<GltfDocument> GltfDocument::open(std::span<const std::byte> bytes, std::optional<std::filesystem::path> folder,
                                        GltfContext* context) {
  auto state = std::make_unique<State>();
  TRY_ASSIGN(const GltfChunks chunks, split_gltf(bytes));
  if (chunks.has_unpadded_chunk) context->notes.add("a chunk of the file is not padded to 4 bytes: read as it is", "");
  TRY(parse_gltf_json(chunks.json, &context->budget, &state->json));
  TRY_ASSIGN(GltfObject root, GltfObject::from(state->json, ""));
  TRY(check_version(root));
  TRY_ASSIGN(state->extensions, check_gltf_extensions(root, &context->notes));
  TRY_ASSIGN(const GltfArray buffers, root.array("buffers"));
  state->buffers.resize(buffers.size());
  state->root = std::move(root);
  state->binary_chunk = chunks.binary;
  state->folder = std::move(folder);
  state->context = context;
  return GltfDocument(std::move(state));
}

const GltfObject& GltfDocument::root() const { return *state_->root; }

bool GltfDocument::uses(std::string_view extension) const {
  return state_->extensions.find(extension) != state_->extensions.end();
}

Result<std::optional<std::size_t>> GltfDocument::index(const GltfObject& from, const char* key,
                                                       const char* list) const {
  TRY_ASSIGN(const std::optional<std::uint64_t> index, from.integer(key));
  if (!index) return std::optional<std::size_t>();
  TRY_ASSIGN(const GltfArray items, root().array(list));
  if (*index >= items.size()) return from.damaged(key, fmt::format("index {} of {} {}", *index, items.size(), list));
  return std::optional(static_cast<std::size_t>(*index));
}

Result<std::size_t> GltfDocument::required_index(const GltfObject& from, const char* key, const char* list) const {
  TRY_ASSIGN(const std::optional<std::size_t> found, index(from, key, list));
  if (!found) return from.damaged(key, "is missing");
  return *found;
}

Result<GltfObject> GltfDocument::item(const char* list, std::size_t index) const {
  TRY_ASSIGN(const GltfArray items, root().array(list));
  return items.object(index);
}

Result<GltfBufferView> GltfDocument::buffer_view(std::size_t index) {
  TRY_ASSIGN(const GltfObject view, item("bufferViews", index));
  TRY_ASSIGN(std::optional<GltfObject> meshopt, view.extension("KHR_meshopt_compression"));
  if (!meshopt) {
    TRY_ASSIGN(meshopt, view.extension("EXT_meshopt_compression"));
  }
  GltfBufferView found;
  if (meshopt) {
    TRY_ASSIGN(found.bytes, decompressed(index, *meshopt));
  } else {
    TRY_ASSIGN(found.bytes, part_of_buffer(view));
  }
  TRY_ASSIGN(found.stride, view.integer("byteStride"));
  found.place = view.place();
  return found;
}

Result<std::span<const std::byte>> GltfDocument::part_of_buffer(const GltfObject& from) {
  TRY_ASSIGN(const std::size_t buffer_index, required_index(from, "buffer", "buffers"));
  TRY_ASSIGN(const std::span<const std::byte> bytes, buffer(buffer_index));
  TRY_ASSIGN(const std::uint64_t length, from.required_integer("byteLength"));
  TRY_ASSIGN(const std::optional<std::uint64_t> offset, from.integer("byteOffset"));
  const std::uint64_t start = offset.value_or(0);
  if (start > bytes.size() || length > bytes.size() - start) {
    return from.damaged("byteLength",
                        fmt::format("{} bytes from byte {} of a buffer of {}", length, start, bytes.size()));
  }
  return bytes.subspan(start, length);
}

Result<std::span<const std::byte>> GltfDocument::decompressed(std::size_t view, const GltfObject& meshopt) {
  const auto known = state_->decompressed.find(view);
  if (known != state_->decompressed.end()) return std::span<const std::byte>(known->second);
  TRY_ASSIGN(const std::span<const std::byte> stored, part_of_buffer(meshopt));
  TRY_ASSIGN(std::vector<std::byte> bytes, decode_meshopt(meshopt, stored, &state_->context->budget));
  return std::span<const std::byte>(state_->decompressed.emplace(view, std::move(bytes)).first->second);
}

Result<std::span<const std::byte>> GltfDocument::buffer(std::size_t index) {
  std::optional<std::span<const std::byte>>& cached = state_->buffers[index];
  if (!cached) {
    TRY_ASSIGN(const GltfObject buffer, item("buffers", index));
    TRY_ASSIGN(cached, load_buffer(buffer, index));
  }
  return *cached;
}

Result<std::span<const std::byte>> GltfDocument::load_buffer(const GltfObject& buffer, std::size_t index) {
  TRY_ASSIGN(const std::uint64_t length, buffer.required_integer("byteLength"));
  TRY_ASSIGN(const std::optional<std::string> uri, buffer.text("uri"));
  std::span<const std::byte> bytes;
  if (uri) {
    TRY_ASSIGN(bytes, resource(buffer, *uri));
  } else if (index == 0 && state_->binary_chunk) {
    bytes = *state_->binary_chunk;
  } else {
    return buffer.damaged("uri", "is missing, and the data is not in this file");
  }
  if (length > bytes.size()) {
    return buffer.damaged("byteLength", fmt::format("there are {} of {} bytes", bytes.size(), length));
  }
  return bytes.first(length);
}

Result<std::span<const std::byte>> GltfDocument::resource(const GltfObject& from, std::string_view uri) {
  const std::string place = from.place() + "/uri";
  if (is_data_uri(uri)) {
    TRY(state_->context->budget.take(place, data_uri_bytes(uri), 1));
    Result<std::vector<std::byte>> decoded = decode_data_uri(uri);
    if (!decoded) return gltf_damaged(place, decoded.error().message());
    state_->decoded.push_back(*std::move(decoded));
    return std::span<const std::byte>(state_->decoded.back());
  }
  const std::filesystem::path folder = state_->folder.value_or(std::filesystem::path());
  Result<std::filesystem::path> path = resolve_relative_uri(folder, uri);
  if (!path) return std::move(path).error().while_doing(place);
  if (!state_->folder) {
    return Error(ErrorCode::kBadData, fmt::format("{}: a scene in memory has no files beside it", place));
  }
  Result<MappedFile> file = MappedFile::open(*path);
  if (!file) return std::move(file).error().while_doing(place);
  // A file to which many references lead counts only once.
  if (state_->earned.insert(*path).second) state_->context->budget.earn(file->bytes().size());
  state_->files.push_back(*std::move(file));
  return state_->files.back().bytes();
}

}  // namespace cyclorama::scene
