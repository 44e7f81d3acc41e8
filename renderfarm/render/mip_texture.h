// SPDX-License-Identifier: Apache-2.0
/// Textures at every size, so that one lookup answers for all texels that a pixel covers.
///
/// Level 0 is the scene's own picture, not copied. Each further level has half the width and half the height of the one
/// before, rounded down, to 1x1; all of them together take a third of level 0. Texels are means over the area that they
/// stand for, with odd sizes too: of linear light where the texture holds colour, of the vectors where it is a normal
/// map. They are stored in the texture's own coding, where roundings add up to about one code value in the last levels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama {

/// What the means are of.
enum class TextureContent : std::uint8_t {
  kColour,           ///< sRGB; alpha does not matter.
  kColourWithAlpha,  ///< sRGB: what is transparent counts for as little in the colour as it shows.
  kData,             ///< Linear: normals, roughness, ...
};

/// Thread-safe to read. Borrows the pixels of the Texture that it was made from, which must outlive it and not change.
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

  /// Uses the threads of the TBB arena that it is called in.
  MipTexture(const Texture& source, TextureContent content);
  MipTexture(MipTexture&&) noexcept = default;
  MipTexture& operator=(MipTexture&&) noexcept = default;

  /// None for an empty picture.
  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
  [[nodiscard]] WrapMode wrap_u() const { return wrap_u_; }
  [[nodiscard]] WrapMode wrap_v() const { return wrap_v_; }
  [[nodiscard]] bool nearest() const { return nearest_; }
  /// Beside the scene's own picture.
  [[nodiscard]] std::size_t bytes() const { return smaller_.size(); }

 private:
  std::vector<Level> levels_;
  std::vector<std::uint8_t> smaller_;  ///< Level 1 and those after it.
  WrapMode wrap_u_;
  WrapMode wrap_v_;
  bool nearest_;
};

/// What MipTexture::bytes() would be.
[[nodiscard]] std::size_t mip_bytes(const Texture& texture);

/// The textures of one model as its materials use them; each is made once for each content. Thread-bound until built,
/// then thread-safe to read.
class MipTextures {
 public:
  /// Null where the use has no texture. The pointer stays, and may be read after build().
  const MipTexture* request(const Model& model, const TextureUse& use, TextureContent content);
  /// Makes what was requested, with `threads` threads (0: all of them).
  void build(int threads);
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::map<std::pair<const Texture*, TextureContent>, std::unique_ptr<MipTexture>> made_;
};

}  // namespace cyclorama
