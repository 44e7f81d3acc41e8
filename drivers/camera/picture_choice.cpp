// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/picture_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cyclorama::camera {
namespace {

/// Rates within this fraction of the preferred one count as equal: NTSC's 29.97 counts as 30.
constexpr double kSameRate = 0.02;
/// Half of the requested rate costs as much as a quarter of the requested pixels.
constexpr double kRateWeight = 4.0;
/// Half of the requested pixels cost as much as a rate that is a quarter below the requested one. Twice the requested
/// pixels cost half as much as half of the requested pixels.
constexpr double kSmallerWeight = 1.0;
constexpr double kLargerWeight = 0.5;

/// Cost of an offer without colour when colour is requested: a calibration accepts a low rate, but it needs colour.
constexpr double kGreyWeight = 100.0;

/// Cost of reading the pixels: a JPEG takes milliseconds, the others a tenth of a millisecond.
double layout_weight(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::kGrey8:
      return 0.0;
    case PixelLayout::kPlanarYuv:
      return 0.005;  // As quick to read as kGrey8, but the unused colour takes bus bandwidth.
    case PixelLayout::kYuyv:
    case PixelLayout::kUyvy:
      return 0.02;
    case PixelLayout::kJpeg:
      return 0.2;
    default:
      return 0.01;
  }
}

double penalty_of(const PictureOffer& offer, const PicturePreference& preferred) {
  const double octaves = std::log2(static_cast<double>(offer.width_px) * offer.height_px) -
                         std::log2(static_cast<double>(preferred.width_px) * preferred.height_px);
  const double size = octaves < 0.0 ? -kSmallerWeight * octaves : kLargerWeight * octaves;
  // With another aspect ratio, part of the picture is cropped or missing.
  const double shape = std::abs(std::log2(static_cast<double>(offer.width_px) / offer.height_px) -
                                std::log2(static_cast<double>(preferred.width_px) / preferred.height_px));
  double rate = 0.0;
  if (offer.frames_per_second > 0.0) {
    const double shortfall = 1.0 - offer.frames_per_second / preferred.frames_per_second;
    if (shortfall > kSameRate) rate = kRateWeight * shortfall;
    // A higher rate than needed leaves less time for the exposure.
    if (shortfall < -kSameRate) rate = 0.05 * std::min(-shortfall, 4.0);
  }
  const double colour = preferred.is_coloured && !offer.is_coloured ? kGreyWeight : 0.0;
  return size + 0.25 * shape + rate + layout_weight(offer.layout) + colour;
}

}  // namespace

Result<std::size_t> choose_picture(const std::vector<PictureOffer>& offers, const PicturePreference& preferred) {
  CHECK(preferred.width_px > 0 && preferred.height_px > 0 && preferred.frames_per_second > 0.0);
  std::size_t best = offers.size();
  double min = 0.0;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    if (offers[i].width_px <= 0 || offers[i].height_px <= 0) continue;
    const double penalty = penalty_of(offers[i], preferred);
    const bool is_tie = best != offers.size() && penalty == min;
    if (best == offers.size() || penalty < min || (is_tie && offers[i].fourcc < offers[best].fourcc)) {
      best = i;
      min = penalty;
    }
  }
  if (best == offers.size()) {
    return Error(ErrorCode::kNotFound, "it offers no pixels that can be read: grey, planar or packed YUV, or JPEG");
  }
  return best;
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const auto letter = static_cast<char>(fourcc >> shift & 0x7fU);
    text += letter > ' ' && letter < 0x7f ? letter : letter == ' ' ? ' ' : '?';
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::string describe(const PictureOffer& offer) {
  const std::string size = fmt::format("{}x{} {}", offer.width_px, offer.height_px, fourcc_text(offer.fourcc));
  return offer.frames_per_second > 0.0 ? fmt::format("{} at {:.4g} per second", size, offer.frames_per_second) : size;
}

}  // namespace cyclorama::camera
