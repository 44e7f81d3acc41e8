// SPDX-License-Identifier: Apache-2.0
/// ETC1S with BasisLZ: textures whose blocks of 4x4 pixels have one colour for all pixels and one brightness for each
/// pixel. Source: KTX 2.0, "BasisLZ Bitstream Specification".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/image/basis_bits.h"
#include "common/image/image.h"

namespace cyclorama {

/// The parts of KTX's supercompression global data that BasisLZ uses. Borrows them.
struct Etc1sSource {
  std::size_t endpoint_count = 0;  ///< At most 65535, like selector_count.
  std::size_t selector_count = 0;
  std::span<const std::byte> endpoints;
  std::span<const std::byte> selectors;
  std::span<const std::byte> tables;
};

/// Colours, selectors and codes that all pictures of a texture share. Thread-safe once read.
class Etc1sCodebook {
 public:
  /// Reads the codebook. Errors: kBadData if it is damaged.
  static Result<Etc1sCodebook> read(const Etc1sSource& source);

  enum class Target { kColour, kAlpha };
  /// Decodes a slice into `ret_image`: into its colour, or, for kAlpha, the green of the slice's colours into its
  /// alpha. Errors: kBadData if the slice is damaged.
  Status decode(std::span<const std::byte> slice, Target target, RgbaImage* ret_image) const;

 private:
  struct Endpoint {
    std::array<std::uint8_t, 3> colour;  ///< 5 bits each.
    std::uint8_t brightness;             ///< Index into the table of modifiers.
  };
  struct Block {
    std::uint32_t endpoint;
    std::uint32_t selector;
  };
  class Slice;

  Status read_endpoints(const Etc1sSource& source);
  Status read_selectors(const Etc1sSource& source);
  Status read_tables(const Etc1sSource& source);
  void paint(const Block& block, int x, int y, Target target, RgbaImage* ret_image) const;

  std::vector<Endpoint> endpoints_;
  std::vector<std::uint32_t> selectors_;  ///< Two bits for each pixel, in rows.
  BasisHuffman prediction_;
  BasisHuffman endpoint_step_;
  BasisHuffman selector_;
  BasisHuffman run_;
  std::size_t history_size_ = 0;
};

}  // namespace cyclorama
