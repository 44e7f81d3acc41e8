// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/watermark_curve.h"

#include <fmt/format.h>

#include "common/base/cpu_time.h"
#include "common/image/jpeg.h"
#include "common/image/watermark_detector.h"
#include "renderfarm/quality/code_error.h"
#include "renderfarm/quality/flip.h"

namespace cyclorama {
namespace {

constexpr std::uint64_t kKey = 0x5eed0f7e57c0de01u;
constexpr int kUsualQuality = 85;
constexpr int kMinPx = 64;

RgbImage marked(const RgbImage& picture, const WatermarkStrength& strength) {
  RgbImage out = picture;
  add_watermark(kKey, {0, 0, picture.width(), picture.height()}, &out, strength);
  return out;
}

RgbImage halved(const RgbImage& picture) {
  RgbImage half(picture.width() / 2, picture.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const int sum = picture.at(2 * x, 2 * y)[c] + picture.at(2 * x + 1, 2 * y)[c] +
                        picture.at(2 * x, 2 * y + 1)[c] + picture.at(2 * x + 1, 2 * y + 1)[c];
        half.at(x, y)[c] = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
  }
  return half;
}

Result<RgbImage> through_jpeg(const RgbImage& picture, int quality) {
  TRY_ASSIGN(const std::vector<std::byte> jpeg, JpegEncoder().encode(picture, {quality, true}));
  return JpegDecoder().decode(jpeg, picture.data().size());
}

Result<double> bytes_of(const RgbImage& picture) {
  TRY_ASSIGN(const std::vector<std::byte> jpeg, JpegEncoder().encode(picture, {kUsualQuality, true}));
  return static_cast<double>(jpeg.size());
}

/// Time for a tile as marked by a node; the best of several runs, since the machine has other work.
double ms_per_megapixel(const WatermarkStrength& strength) {
  constexpr int kSide = 256;
  constexpr int kTiles = 200;
  RgbImage tile(kSide, kSide, 128);
  double best = 1e9;
  for (int i = 0; i < kTiles; ++i) {
    const double begun = thread_cpu_seconds();
    add_watermark(kKey, {kSide * i, 0, kSide, kSide}, &tile, strength);
    best = std::min(best, thread_cpu_seconds() - begun);
  }
  return 1e3 * best / (1e-6 * kSide * kSide);
}

Result<WatermarkPoint> measure(const RgbImage& picture, double plain_bytes, const WatermarkStrength& strength) {
  WatermarkPoint point{strength};
  const RgbImage grey(512, 512, 128);
  const RgbImage grey_marked = marked(grey, strength);
  TRY_ASSIGN(point.grey_psnr_db, quality::psnr(grey_marked, grey));
  TRY_ASSIGN(const quality::Flip grey_flip, quality::flip(grey_marked, grey));
  point.grey_flip = grey_flip.mean;
  const RgbImage bearing = marked(picture, strength);
  TRY_ASSIGN(const quality::Flip picture_flip, quality::flip(bearing, picture));
  point.flip = picture_flip.mean;
  TRY_ASSIGN(const double bytes, bytes_of(bearing));
  point.more_bytes = bytes / plain_bytes - 1.0;
  point.ms_per_megapixel = ms_per_megapixel(strength);
  for (std::size_t i = 0; i < kWatermarkQualities.size(); ++i) {
    TRY_ASSIGN(const RgbImage shown, through_jpeg(bearing, kWatermarkQualities[i]));
    point.scores[i] = WatermarkDetector(shown, kWatermarkCellPx, strength.sparseness).score(kKey);
  }
  TRY_ASSIGN(const RgbImage half, through_jpeg(halved(bearing), kUsualQuality));
  point.half_score = WatermarkDetector(half, kWatermarkCellPx / 2, strength.sparseness).score(kKey);
  return point;
}

}  // namespace

Result<std::vector<WatermarkPoint>> measure_watermark(const RgbImage& picture) {
  if (picture.width() < kMinPx || picture.height() < kMinPx) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("the picture has {} x {} pixels; a mark needs {} x {}",
                                                          picture.width(), picture.height(), kMinPx, kMinPx));
  }
  TRY_ASSIGN(const double plain_bytes, bytes_of(picture));
  std::vector<WatermarkPoint> points;
  for (const int amplitude : {1, 2, 3}) {
    for (const int sparseness : {4, 3, 2, 1, 0}) {
      TRY_ASSIGN(WatermarkPoint point, measure(picture, plain_bytes, {amplitude, sparseness}));
      points.push_back(point);
    }
  }
  return points;
}

}  // namespace cyclorama
