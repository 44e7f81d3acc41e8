// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/jpeg_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/base/cpu_time.h"
#include "common/image/pixel_rect.h"

namespace cyclorama {
namespace {

constexpr std::array kQualities{50, 60, 70, 75, 80, 85, 90, 95};
constexpr std::array kTiles{512, 256, 128, 64, 32};
constexpr int kUsualTilePx = 256;
constexpr int kUsualQuality = 85;
/// The best of this many rounds counts, since the machine has other work.
constexpr int kRounds = 5;

std::vector<PixelRect> tiles(const RgbImage& picture, int side) {
  std::vector<PixelRect> rects;
  for (int y = 0; y < picture.height(); y += side) {
    for (int x = 0; x < picture.width(); x += side) {
      rects.push_back({x, y, std::min(side, picture.width() - x), std::min(side, picture.height() - y)});
    }
  }
  return rects;
}

Result<JpegPoint> measure(const RgbImage& picture, int tile_px, const JpegOptions& options) {
  JpegPoint point{tile_px, options};
  const std::vector<PixelRect> rects = tiles(picture, tile_px);
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(picture.width());
  const double megapixels = 1e-6 * picture.width() * picture.height();
  JpegEncoder encoder;
  JpegDecoder decoder;
  RgbImage shown(picture.width(), picture.height());
  double encode_seconds = 1e9;
  double decode_seconds = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::vector<std::byte>> jpegs;
    const double begun = thread_cpu_seconds();
    for (const PixelRect& rect : rects) {
      TRY_ASSIGN(auto jpeg, encoder.encode(picture.at(rect.x, rect.y), rect.width, rect.height, row_bytes, options));
      jpegs.push_back(std::move(jpeg));
    }
    const double encoded = thread_cpu_seconds();
    point.bytes = 0;
    for (std::size_t i = 0; i < rects.size(); ++i) {
      const PixelRect& rect = rects[i];
      point.bytes += jpegs[i].size();
      TRY(decoder.decode_into(jpegs[i], shown.at(rect.x, rect.y), rect.width, rect.height, row_bytes));
    }
    encode_seconds = std::min(encode_seconds, encoded - begun);
    decode_seconds = std::min(decode_seconds, thread_cpu_seconds() - encoded);
  }
  point.encode_ms_per_megapixel = 1e3 * encode_seconds / megapixels;
  point.decode_ms_per_megapixel = 1e3 * decode_seconds / megapixels;
  TRY_ASSIGN(point.error, quality::shown_error(shown, picture));
  return point;
}

}  // namespace

Result<std::vector<JpegPoint>> measure_jpeg(const RgbImage& picture) {
  if (picture.width() < kTiles.back() || picture.height() < kTiles.back()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("the picture has {} x {} pixels; the smallest tile has {} x {}", picture.width(),
                             picture.height(), kTiles.back(), kTiles.back()));
  }
  std::vector<JpegPoint> points;
  for (const bool subsample : {true, false}) {
    for (const int quality : kQualities) {
      TRY_ASSIGN(const JpegPoint point, measure(picture, kUsualTilePx, {quality, subsample}));
      points.push_back(point);
    }
  }
  for (const int tile_px : kTiles) {
    TRY_ASSIGN(const JpegPoint point, measure(picture, tile_px, {kUsualQuality, true}));
    points.push_back(point);
  }
  TRY_ASSIGN(const JpegPoint whole,
             measure(picture, std::max(picture.width(), picture.height()), {kUsualQuality, true}));
  points.push_back(whole);
  return points;
}

}  // namespace cyclorama
