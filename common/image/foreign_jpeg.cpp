// SPDX-License-Identifier: Apache-2.0
#include "common/image/foreign_jpeg.h"

#include <fmt/format.h>

// jpeglib.h requires stdio's FILE.
#include <cstdio>

#include <jpeglib.h>

#include <jerror.h>

#include <array>
#include <csetjmp>
#include <string>

namespace cyclorama {
namespace {

constexpr int kMaxScans = 500;  // Without this limit, a progressive file of a few kilobytes could take hours.

struct Failure {
  jpeg_error_mgr manager;
  std::jmp_buf leave;
  std::array<char, JMSG_LENGTH_MAX> message{};
};

[[noreturn]] void fail(j_common_ptr info) {
  auto* const failure = reinterpret_cast<Failure*>(info->err);
  (*info->err->format_message)(info, failure->message.data());
  std::longjmp(failure->leave, 1);
}

/// Tolerates bytes without meaning: of libjpeg's warnings, only this one leaves the picture whole.
void at_message(j_common_ptr info, int level) {
  if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA) fail(info);
}

void check_scans(j_common_ptr info) {
  const auto* const decoder = reinterpret_cast<const jpeg_decompress_struct*>(info);
  if (info->is_decompressor == 0 || decoder->input_scan_number <= kMaxScans) return;
  ERREXIT(info, JERR_BAD_PROGRESSION);
}

/// libjpeg's state. Its functions fail by longjmp(), which skips destructors, so no function in between may have
/// objects with destructors.
class Decoder {
 public:
  Decoder() {
    info_.err = jpeg_std_error(&failure_.manager);
    failure_.manager.error_exit = &fail;
    failure_.manager.emit_message = &at_message;
    jpeg_create_decompress(&info_);
    info_.progress = &progress_;
    progress_.progress_monitor = &check_scans;
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { jpeg_destroy_decompress(&info_); }

  /// Reads up to the first scan. Returns false on failure.
  bool read_header(std::span<const std::byte> jpeg) {
    if (setjmp(failure_.leave) != 0) return false;
    jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size());
    jpeg_read_header(&info_, TRUE);
    return true;
  }
  /// Fills `pixels`, four values per pixel; CMYK remains as it is stored. Returns false on failure.
  bool read_pixels(std::uint8_t* pixels) {
    if (setjmp(failure_.leave) != 0) return false;
    info_.out_color_space = is_cmyk() ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg_start_decompress(&info_);
    const std::size_t row_bytes = std::size_t{4} * info_.output_width;
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = pixels + row_bytes * info_.output_scanline;
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return true;
  }

  [[nodiscard]] std::size_t width() const { return info_.image_width; }
  [[nodiscard]] std::size_t height() const { return info_.image_height; }
  [[nodiscard]] bool is_cmyk() const {
    return info_.jpeg_color_space == JCS_CMYK || info_.jpeg_color_space == JCS_YCCK;
  }
  /// True if ink is stored as 255 - ink, as Adobe's programs do.
  [[nodiscard]] bool is_inverted() const { return info_.saw_Adobe_marker != 0; }
  [[nodiscard]] std::string message() const { return failure_.message.data(); }

 private:
  jpeg_decompress_struct info_{};
  jpeg_progress_mgr progress_{};
  Failure failure_{};
};

void convert_cmyk(bool inverted, std::span<std::uint8_t> pixels) {
  const auto paper = [&](std::uint8_t ink) { return inverted ? unsigned{ink} : 255u - ink; };
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    const unsigned black = paper(pixels[i + 3]);
    for (std::size_t c = 0; c < 3; ++c) {
      pixels[i + c] = static_cast<std::uint8_t>((paper(pixels[i + c]) * black + 127u) / 255u);
    }
    pixels[i + 3] = 255;
  }
}

}  // namespace

Result<RgbaImage> decode_foreign_jpeg(std::span<const std::byte> jpeg, std::size_t limit_px) {
  Decoder decoder;
  if (!decoder.read_header(jpeg)) {
    return Error(ErrorCode::kBadData, fmt::format("reading the JPEG header: {}", decoder.message()));
  }
  if (decoder.width() * decoder.height() > limit_px) {
    return Error(ErrorCode::kBadData, fmt::format("the JPEG has {}x{} pixels; at most {} pixels are accepted here",
                                                  decoder.width(), decoder.height(), limit_px));
  }
  RgbaImage image(static_cast<int>(decoder.width()), static_cast<int>(decoder.height()));
  if (!decoder.read_pixels(image.data().data())) {
    return Error(ErrorCode::kBadData, fmt::format("decoding JPEG: {}", decoder.message()));
  }
  if (decoder.is_cmyk()) convert_cmyk(decoder.is_inverted(), image.data());
  return image;
}

}  // namespace cyclorama
