// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/mask_png.h"

#include <spng.h>

#include <cstdlib>
#include <cstring>
#include <memory>

#include "appliance/interchange/fault.h"

namespace cyclorama {
namespace {

constexpr std::size_t kChunkLimitBytes = std::size_t{1} << 20;
constexpr int kQuick = 3;

using Context = std::unique_ptr<spng_ctx, void (*)(spng_ctx*)>;

Context make_context(int flags) {
  Context context(spng_ctx_new(flags), spng_ctx_free);
  CHECK(context != nullptr);
  return context;
}

Error broken(const char* place, int code) { return fault(place, spng_strerror(code), "export the mask again"); }

/// How the library hands out the pixels of such a file.
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
  const Context context = make_context(0);
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
  // The pixels are whole, but what follows them tells a file that was cut.
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
  const Context context = make_context(SPNG_CTX_ENCODER);
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, kQuick);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(mask.width_px);
  header.height = static_cast<std::uint32_t>(mask.height_px);
  header.bit_depth = static_cast<std::uint8_t>(mask.bits);
  header.color_type = mask.channels == 3 ? SPNG_COLOR_TYPE_TRUECOLOR : SPNG_COLOR_TYPE_GRAYSCALE;
  spng_set_ihdr(context.get(), &header);
  std::vector<std::uint8_t> narrow;
  const void* pixels = mask.samples.data();
  std::size_t bytes = mask.samples.size() * sizeof(std::uint16_t);
  if (mask.bits == 8) {
    for (const std::uint16_t sample : mask.samples) narrow.push_back(static_cast<std::uint8_t>(sample));
    pixels = narrow.data();
    bytes = narrow.size();
  }
  if (const int e = spng_encode_image(context.get(), pixels, bytes, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE)) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("encoding a mask as PNG: {}", spng_strerror(e)));
  }
  std::size_t size = 0;
  int e = 0;
  const std::unique_ptr<void, void (*)(void*)> buffer(spng_get_png_buffer(context.get(), &size, &e), std::free);
  if (buffer == nullptr) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("encoding a mask as PNG: {}", spng_strerror(e)));
  }
  const auto* const begin = static_cast<const std::byte*>(buffer.get());
  return std::vector<std::byte>(begin, begin + size);
}

}  // namespace cyclorama
