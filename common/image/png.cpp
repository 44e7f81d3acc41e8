// SPDX-License-Identifier: Apache-2.0
#include "common/image/png.h"

#include <fmt/format.h>
#include <spng.h>

#include <cstdlib>
#include <memory>

#include "common/base/file.h"
#include "common/image/png_samples.h"

namespace cyclorama {
namespace {

constexpr std::size_t kChunkLimitBytes = 64u << 20;  // Limit of one ancillary chunk, and of all cached chunks.
constexpr int kQuick = 3;

using Context = std::unique_ptr<spng_ctx, void (*)(spng_ctx*)>;

Context make_context(int flags) {
  Context context(spng_ctx_new(flags), spng_ctx_free);
  CHECK(context != nullptr);
  return context;
}

Error bad(const char* doing, int code) {
  return Error(ErrorCode::kBadData, fmt::format("{}: {}", doing, spng_strerror(code)));
}

}  // namespace

Result<RgbaImage> decode_png(std::span<const std::byte> png, std::size_t limit_px) {
  const Context context = make_context(0);
  spng_set_chunk_limits(context.get(), kChunkLimitBytes, kChunkLimitBytes);
  if (const int e = spng_set_png_buffer(context.get(), png.data(), png.size())) return bad("reading PNG", e);
  spng_ihdr header{};
  if (const int e = spng_get_ihdr(context.get(), &header)) return bad("reading the PNG header", e);
  if (std::size_t{header.width} * header.height > limit_px) {
    return Error(ErrorCode::kBadData, fmt::format("the PNG has {}x{} pixels; at most {} pixels are accepted here",
                                                  header.width, header.height, limit_px));
  }
  RgbaImage image(static_cast<int>(header.width), static_cast<int>(header.height));
  const int flags = SPNG_DECODE_TRNS;
  if (const int e = spng_decode_image(context.get(), image.data().data(), image.data().size(), SPNG_FMT_RGBA8, flags)) {
    return bad("decoding PNG", e);
  }
  return image;
}

Result<std::vector<std::byte>> encode_png(const PngSamples& picture) {
  const auto refused = [](int code) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("encoding PNG: {}", spng_strerror(code)));
  };
  const Context context = make_context(SPNG_CTX_ENCODER);
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, kQuick);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(picture.width_px);
  header.height = static_cast<std::uint32_t>(picture.height_px);
  header.bit_depth = static_cast<std::uint8_t>(picture.bits);
  header.color_type = picture.channels == 3 ? SPNG_COLOR_TYPE_TRUECOLOR : SPNG_COLOR_TYPE_GRAYSCALE;
  spng_set_ihdr(context.get(), &header);
  if (const int e = spng_encode_image(context.get(), picture.samples.data(), picture.samples.size(), SPNG_FMT_PNG,
                                      SPNG_ENCODE_FINALIZE)) {
    return refused(e);
  }
  std::size_t size = 0;
  int e = 0;
  const std::unique_ptr<void, void (*)(void*)> buffer(spng_get_png_buffer(context.get(), &size, &e), std::free);
  if (buffer == nullptr) return refused(e);
  const auto* const begin = static_cast<const std::byte*>(buffer.get());
  return std::vector<std::byte>(begin, begin + size);
}

Result<std::vector<std::byte>> encode_png(const RgbImage& image) {
  if (image.empty()) return Error(ErrorCode::kInvalidArgument, "an empty picture cannot be written as PNG");
  return encode_png(PngSamples{image.width(), image.height(), 3, 8, std::as_bytes(image.data())});
}

Status write_png(const std::filesystem::path& path, const RgbImage& image) {
  TRY_ASSIGN(const std::vector<std::byte> bytes, encode_png(image));
  return write_file_atomically(path, bytes);
}

}  // namespace cyclorama
