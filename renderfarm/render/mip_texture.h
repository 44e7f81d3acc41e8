// SPDX-License-Identifier: Apache-2.0
/// Mipmapped textures: one lookup returns the mean of all texels that a pixel covers.
///
/// Level 0 is the scene's own image, not copied. Each further level has half the width and half the height of the one
/// before, rounded down, to 1x1; together they take a third of level 0. Each texel is the mean over the area that it
/// covers, even if a size is odd: the mean of linear light for colour textures, of the vectors for normal maps. Texels
/// are stored in the texture's coding; rounding accumulates to about one code value in the last levels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::render {

/// Kind of values that a texture holds, which determines how they are averaged.
enum class TextureContent : std::uint8_t {
  kColour,           ///< sRGB; alpha does not matter.
  kColourWithAlpha,  ///< sRGB; colour is weighted by alpha.
  kData,             ///< Linear: normals, roughness, ...
};

/// A texture and its smaller levels. Borrows the pixels of the Texture that it was made from, which must outlive it and
/// not change. Thread-safe to read.
class MipTexture {
 public:
  struct Level {
    const std::uint8_t* texels = nullptr;  ///< RGBA, rows from the top.
    int width = 0;
    int height = 0;
    [[nodiscard]] const std::uint8_t* at(int x, int y) const {
      return texels + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    }
  };

  /// Uses the threads of the TBB arena in which it is called.
  MipTexture(const scene::Texture& source, TextureContent content);
  MipTexture(MipTexture&&) noexcept = default;
  MipTexture& operator=(MipTexture&&) noexcept = default;

  /// Empty for a texture without pixels.
  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
  [[nodiscard]] scene::WrapMode wrap_u() const { return wrap_u_; }
  [[nodiscard]] scene::WrapMode wrap_v() const { return wrap_v_; }
  [[nodiscard]] bool nearest() const { return nearest_; }
  /// Returns the memory used in addition to the scene's image.
  [[nodiscard]] std::size_t bytes() const { return smaller_.size(); }

 private:
  std::vector<Level> levels_;
  std::vector<std::uint8_t> smaller_;  ///< Levels 1 and up.
  scene::WrapMode wrap_u_;
  scene::WrapMode wrap_v_;
  bool nearest_;
};

/// Returns MipTexture::bytes() of `texture` without creating it.
[[nodiscard]] std::size_t mip_bytes(const scene::Texture& texture);

/// The textures of one model as its materials use them; each is created once for each TextureContent. Thread-bound
/// until built, then thread-safe to read.
class MipTextures {
 public:
  /// Requests a texture; returns null if `use` has none. The pointer stays valid; the texture may be read after
  /// build().
  const MipTexture* request(const scene::Model& model, const scene::TextureUse& use, TextureContent content);
  /// Creates the requested textures with `threads` threads (0 uses all cores).
  void build(int threads);
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::map<std::pair<const scene::Texture*, TextureContent>, std::unique_ptr<MipTexture>> made_;
};

}  // namespace cyclorama::render
