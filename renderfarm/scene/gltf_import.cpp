// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_import.h"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <utility>

#include "common/base/file.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/gltf_mesh.h"
#include "renderfarm/scene/gltf_node.h"

namespace cyclorama::scene {
namespace {

Result<Model> import_checked(std::span<const std::byte> bytes, const std::optional<std::filesystem::path>& folder,
                             const ImportLimits& limits) {
  GltfContext context(limits);
  context.budget.earn(bytes.size());
  TRY_ASSIGN(GltfDocument document, GltfDocument::open(bytes, folder, &context));
  Model model;
  GltfMeshes meshes(&document, &context, &model);
  TRY(show_gltf_scene(&document, &context, &meshes, &model));
  if (model.instances.empty() && model.splats.empty()) context.notes.add("the file shows no triangles", "");
  if (model.materials.empty()) model.materials.emplace_back();
  model.notes = context.notes.sentences();
  TRY_ASSIGN(const std::optional<GltfObject> asset, document.root().object("asset"));
  if (asset) {
    TRY_ASSIGN(model.credits, asset->text_or("copyright", ""));
  }
  return model;
}

}  // namespace

Result<Model> import_gltf_bytes(std::span<const std::byte> bytes, const std::optional<std::filesystem::path>& folder,
                                const ImportLimits& limits) {
  try {
    return import_checked(bytes, folder, limits);
  } catch (const std::bad_alloc&) {
    return Error(ErrorCode::kSystem, "there is not enough memory for this scene; simplify it, or use a larger machine");
  } catch (const std::exception& e) {
    // Draco, the JSON library and std::filesystem may throw at unpredictable points.
    return Error(ErrorCode::kBadData, fmt::format("the file cannot be read: {}", e.what()));
  }
}

Result<Model> import_gltf(const std::filesystem::path& path, const ImportLimits& limits) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  Result<Model> model = import_gltf_bytes(file.bytes(), path.parent_path(), limits);
  if (!model) return std::move(model).error().while_doing(path.string());
  return model;
}

}  // namespace cyclorama::scene
