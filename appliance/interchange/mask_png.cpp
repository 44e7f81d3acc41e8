// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/mask_png.h"

#include <spng.h>

#include <cstring>
#include <memory>

#include "appliance/interchange/fault.h"
#include "common/image/png_samples.h"

namespace cyclorama::interchange {
namespace {

constexpr std::size_t kChunkLimitBytes = std::size_t{1} << 20;

Error broken(const char* location, int code) { return fault(location, spng_strerror(code), "export the mask again"); }

/// Output format that is requested from the library.
struct Layout {
  int format = SPNG_FMT_PNG;
  std::size_t stored_channels = 1;
  int bits = 8;
};

Layout layout_of(const spng_ihdr& header) {
  if (header.color_type == SPNG_COLOR_TYPE_INDEXED) return {SPNG_FMT_RGB8, 3, 8};
  if (header.bit_depth < 8) return {SPNG_FMT_G8, 1, 8};
  const int bits = header.bit_depth;
  switch (header.color_type) {
    case SPNG_COLOR_TYPE_GRAYSCALE:
      return {SPNG_FMT_PNG, 1, bits};
    case SPNG_COLOR_TYPE_GRAYSCALE_ALPHA:
      return {SPNG_FMT_PNG, 2, bits};
    case SPNG_COLOR_TYPE_TRUECOLOR:
      return {SPNG_FMT_PNG, 3, bits};
    default:
      return {SPNG_FMT_PNG, 4, bits};
  }
}

}  // namespace

Result<MaskMap> decode_mask_png(std::span<const std::byte> png, std::size_t limit_px) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(0), spng_ctx_free);
  CHECK(context != nullptr);
  spng_set_chunk_limits(context.get(), kChunkLimitBytes, kChunkLimitBytes);
  if (const int e = spng_set_png_buffer(context.get(), png.data(), png.size())) return broken("PNG", e);
  spng_ihdr header{};
  if (const int e = spng_get_ihdr(context.get(), &header)) return broken("PNG header", e);
  if (header.width > limit_px / header.height) {
    return fault("PNG header",
                 fmt::format("{}x{} pixels, and at most {} are accepted", header.width, header.height, limit_px),
                 "export a smaller mask");
  }
  const Layout layout = layout_of(header);
  std::size_t size = 0;
  if (const int e = spng_decoded_image_size(context.get(), layout.format, &size)) return broken("PNG header", e);
  const std::size_t pixels = std::size_t{header.width} * header.height;
  const std::size_t sample_bytes = layout.bits == 16 ? 2 : 1;
  CHECK(size == pixels * layout.stored_channels * sample_bytes);
  std::vector<std::byte> stored(size);
  if (const int e = spng_decode_image(context.get(), stored.data(), stored.size(), layout.format, 0)) {
    return broken("PNG pixels", e);
  }
  // The pixels are complete, but the chunks after them reveal a truncated file.
  if (const int e = spng_decode_chunks(context.get())) return broken("PNG end", e);
  const int channels = layout.stored_channels < 3 ? 1 : 3;
  MaskMap mask(static_cast<int>(header.width), static_cast<int>(header.height), channels, layout.bits);
  const auto kept = static_cast<std::size_t>(channels);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < kept; ++c) {
      const std::byte* const from = stored.data() + (i * layout.stored_channels + c) * sample_bytes;
      std::uint16_t sample = 0;
      if (sample_bytes == 2) {
        std::memcpy(&sample, from, sizeof(sample));
      } else {
        sample = static_cast<std::uint16_t>(*from);
      }
      mask.samples[i * kept + c] = sample;
    }
  }
  return mask;
}

Result<std::vector<std::byte>> encode_mask_png(const MaskMap& mask) {
  PngSamples png{mask.width_px, mask.height_px, mask.channels, mask.bits, std::as_bytes(std::span(mask.samples))};
  std::vector<std::uint8_t> narrow;
  if (mask.bits == 8) {
    for (const std::uint16_t sample : mask.samples) narrow.push_back(static_cast<std::uint8_t>(sample));
    png.samples = std::as_bytes(std::span(narrow));
  }
  return encode_png(png);
}

}  // namespace cyclorama::interchange
