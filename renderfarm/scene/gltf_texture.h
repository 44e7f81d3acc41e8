// SPDX-License-Identifier: Apache-2.0
/// glTF's textures, images and samplers.
#pragma once

#include <cstddef>
#include <map>
#include <tuple>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_document.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Loads each texture when a visible material first needs it. Borrows its arguments. Thread-bound.
class GltfTextures {
 public:
  GltfTextures(GltfDocument* document, GltfContext* context, std::vector<Texture>* ret_textures)
      : document_(document), context_(context), textures_(ret_textures) {}

  /// Returns an index into Model::textures. Returns -1, with a note that names the picture, if the picture is missing,
  /// damaged or of another format: the surface then stays plain, because a visit with one missing texture is better
  /// than none. Errors: kBadData if the references are wrong or the pixels exceed the budget. Precondition: `index`
  /// came from GltfDocument::index().
  Result<int> load(std::size_t index);

 private:
  Result<int> load_new(std::size_t index);
  Result<int> load_picture(std::size_t image_index, Texture texture);
  Result<RgbaImage> decode(const GltfObject& image);

  GltfDocument* document_;
  GltfContext* context_;
  std::vector<Texture>* textures_;
  std::map<std::size_t, int> loaded_;
  /// Keyed by image and sampler, because many files have a texture for each use of a picture.
  std::map<std::tuple<std::size_t, WrapMode, WrapMode, bool>, int> decoded_;
};

}  // namespace cyclorama::scene
