// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "common/base/text.h"
#include "common/image/image_file.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kPixelBytes = 4;
// While a JPEG is decoded, its three bytes per pixel are in memory in addition to the four of the result.
constexpr std::size_t kDecodingBytesPerPixel = 8;

Result<WrapMode> read_wrap(const GltfObject& sampler, const char* key) {
  TRY_ASSIGN(const std::optional<std::uint64_t> mode, sampler.integer(key));
  switch (mode.value_or(10497)) {
    case 10497:
      return WrapMode::kRepeat;
    case 33071:
      return WrapMode::kClamp;
    case 33648:
      return WrapMode::kMirror;
    default:
      return sampler.damaged(key, fmt::format("{} is no wrap mode", *mode));
  }
}

Status read_sampler(const GltfDocument& document, const GltfObject& texture, Texture* ret_texture) {
  TRY_ASSIGN(const std::optional<std::size_t> index, document.index(texture, "sampler", "samplers"));
  if (!index) return Done{};
  TRY_ASSIGN(const GltfObject sampler, document.item("samplers", *index));
  TRY_ASSIGN(ret_texture->wrap_u, read_wrap(sampler, "wrapS"));
  TRY_ASSIGN(ret_texture->wrap_v, read_wrap(sampler, "wrapT"));
  TRY_ASSIGN(const std::optional<std::uint64_t> filter, sampler.integer("magFilter"));
  constexpr std::uint64_t kNearest = 9728;
  ret_texture->nearest = filter == kNearest;
  return Done{};
}

std::string image_name(const GltfObject& image, const std::optional<std::string>& uri) {
  if (uri && uri->substr(0, 5) != "data:") return fmt::format("'{}'", printable(*uri));
  const std::string name = image.name();
  return name.empty() ? image.place() : fmt::format("'{}'", printable(name));
}

/// Returns the index of the texture's picture: the WebP or KTX2 picture if there is one, because any other picture is
/// then a fallback for programs that cannot read these formats.
Result<std::optional<std::size_t>> source_of(const GltfDocument& document, const GltfObject& texture) {
  for (const char* const name : {"EXT_texture_webp", "KHR_texture_basisu"}) {
    TRY_ASSIGN(const std::optional<GltfObject> extension, texture.extension(name));
    if (extension) return document.index(*extension, "source", "images");
  }
  return document.index(texture, "source", "images");
}

Result<std::string> why_no_source(const GltfObject& texture) {
  for (const char* const name : {"EXT_texture_avif", "MSFT_texture_dds"}) {
    TRY_ASSIGN(const std::optional<GltfObject> extension, texture.extension(name));
    if (extension) return fmt::format("a texture is stored by {} only, which is not supported", name);
  }
  return std::string("a texture has no PNG, JPEG, WebP or KTX2 picture");
}

}  // namespace

Result<int> GltfTextures::load(std::size_t index) {
  const auto known = loaded_.find(index);
  if (known != loaded_.end()) return known->second;
  TRY_ASSIGN(const int loaded, load_new(index));
  loaded_.emplace(index, loaded);
  return loaded;
}

Result<int> GltfTextures::load_new(std::size_t index) {
  TRY_ASSIGN(const GltfObject object, document_->item("textures", index));
  TRY_ASSIGN(const std::optional<std::size_t> source, source_of(*document_, object));
  if (!source) {
    TRY_ASSIGN(const std::string why, why_no_source(object));
    context_->notes.add(why + ": its surfaces stay plain", object.place());
    return -1;
  }
  Texture texture;
  TRY(read_sampler(*document_, object, &texture));
  const auto key = std::make_tuple(*source, texture.wrap_u, texture.wrap_v, texture.nearest);
  const auto known = decoded_.find(key);
  if (known != decoded_.end()) return known->second;
  TRY_ASSIGN(const int loaded, load_picture(*source, std::move(texture)));
  decoded_.emplace(key, loaded);
  return loaded;
}

Result<int> GltfTextures::load_picture(std::size_t image_index, Texture texture) {
  TRY_ASSIGN(const GltfObject image, document_->item("images", image_index));
  Result<RgbaImage> pixels = decode(image);
  if (!pixels) {
    TRY_ASSIGN(const std::optional<std::string> uri, image.text("uri"));
    context_->notes.add(fmt::format("image {} is not used, its surfaces stay plain: {}", image_name(image, uri),
                                    pixels.error().message()),
                        image.place());
    return -1;
  }
  texture.pixels = *std::move(pixels);
  TRY(context_->budget.take(image.place(), texture.pixels.data().size() / kPixelBytes, kPixelBytes));
  textures_->push_back(std::move(texture));
  return static_cast<int>(textures_->size()) - 1;
}

Result<RgbaImage> GltfTextures::decode(const GltfObject& image) {
  TRY_ASSIGN(const std::optional<std::string> uri, image.text("uri"));
  std::span<const std::byte> bytes;
  if (uri) {
    TRY_ASSIGN(bytes, document_->resource(image, *uri));
  } else {
    TRY_ASSIGN(const std::size_t view_index, document_->required_index(image, "bufferView", "bufferViews"));
    TRY_ASSIGN(const GltfBufferView view, document_->buffer_view(view_index));
    bytes = view.bytes;
  }
  const std::size_t affordable_px = context_->budget.left_bytes() / kDecodingBytesPerPixel;
  return decode_image(bytes, std::min(context_->limits.texture_px, affordable_px));
}

}  // namespace cyclorama::scene
