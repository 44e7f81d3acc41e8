// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/decoder.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "appliance/structured_light/patches.h"

namespace cyclorama::structured_light {
namespace {

/// Bits whose stripes separate direct and global light: stripes of 16 to 64 pixels, if the projector is large enough.
/// These are narrow compared with the blur of indirect light, and wide compared with the blur of the lens.
constexpr int kSeparatingBit = 3;
constexpr int kSeparatingBits = 3;
int separating_bit(const AxisBits& axis) {
  return std::max(axis.finest_bit, std::min(kSeparatingBit, axis.bits - kSeparatingBits));
}

Error bad(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

bool is_bit(const PatternPicture& picture) { return picture.kind == PatternKind::kBit; }

Status check_pairs(const PatternSet& set) {
  bool has_white = false;
  bool has_black = false;
  for (std::size_t i = 0; i < set.pictures.size(); ++i) {
    const PatternPicture& picture = set.pictures[i];
    has_white |= picture.kind == PatternKind::kWhite;
    has_black |= picture.kind == PatternKind::kBlack;
    if (!is_bit(picture)) continue;
    PatternPicture inverse = picture;
    inverse.is_inverse = true;
    if (picture.is_inverse || i + 1 == set.pictures.size() || !(set.pictures[i + 1] == inverse)) {
      return bad("picture " + std::to_string(i) + " (" + name_of(picture) +
                 "): every bit needs its inverse right after it");
    }
    if (picture.bit < 0 || picture.bit > 14)
      return bad("bits 0 to 14 can be decoded, not " + std::to_string(picture.bit));
    ++i;
  }
  if (!has_white || !has_black) return bad("a set is decoded with its white and its black picture: add them");
  return Done{};
}

Result<AxisBits> empty_axis(const PatternSet& set, PatternAxis axis) {
  AxisBits reading;
  reading.base_bit = set.base_bit;
  reading.extent_px = axis == PatternAxis::kColumns ? set.width_px : set.height_px;
  reading.bits = bits_for(reading.extent_px);
  reading.finest_bit = reading.bits;
  std::vector<int> seen(static_cast<std::size_t>(reading.bits), 0);
  for (const PatternPicture& picture : set.pictures) {
    if (!is_bit(picture) || picture.axis != axis || picture.is_inverse) continue;
    if (picture.bit >= reading.bits) return bad(name_of(picture) + ": the projector has no such pixels");
    ++seen[static_cast<std::size_t>(picture.bit)];
    reading.finest_bit = std::min(reading.finest_bit, picture.bit);
  }
  for (int bit = reading.finest_bit; bit < reading.bits; ++bit) {
    if (seen[static_cast<std::size_t>(bit)] != 1)
      return bad("every bit from the highest down to the finest is shown once per axis");
  }
  if (reading.finest_bit == reading.bits) return bad("no bits: the stripes cannot be distinguished");
  if (reading.base_bit >= 0 && (reading.base_bit < reading.finest_bit || reading.base_bit >= reading.bits)) {
    return bad("the base bit is not shown");
  }
  reading.differences.resize(static_cast<std::size_t>(reading.bits));
  return reading;
}

}  // namespace

Result<Decoder> Decoder::from(const PatternSet& set, const DecodeSettings& settings, int width_px, int height_px) {
  if (width_px < 1 || height_px < 1 || width_px > 65536 || height_px > 65536)
    return bad("a photograph of no pixels, or of more than 65536 a side");
  TRY(check_pairs(set));
  Decoder decoder(set, settings, width_px, height_px);
  TRY_ASSIGN(decoder.axes_[0], empty_axis(set, PatternAxis::kColumns));
  TRY_ASSIGN(decoder.axes_[1], empty_axis(set, PatternAxis::kRows));
  if (set.phase_steps > 0) decoder.phases_.fill(PhaseReading(set.phase_period_px, set.phase_steps));
  return decoder;
}

Decoder::Decoder(const PatternSet& set, const DecodeSettings& settings, int width_px, int height_px)
    : set_(set),
      settings_(settings),
      width_px_(width_px),
      height_px_(height_px),
      sums_(width_px, height_px),
      min_(width_px, height_px, 1e9f),
      max_(width_px, height_px, -1e9f) {}

Status Decoder::add(const Photo& photo) {
  if (next_ >= set_.pictures.size()) return bad("the set has no more than " + std::to_string(next_) + " pictures");
  if (photo.width() != width_px_ || photo.height() != height_px_) {
    return bad("a photograph of " + std::to_string(photo.width()) + "x" + std::to_string(photo.height()) +
               " among those of " + std::to_string(width_px_) + "x" + std::to_string(height_px_));
  }
  if (!std::all_of(photo.data().begin(), photo.data().end(), [](float light) { return std::abs(light) <= 1e6f; })) {
    return bad("a photograph with pixels that are not numbers: look at what takes off the camera's response");
  }
  const PatternPicture& picture = set_.pictures[next_++];
  switch (picture.kind) {
    case PatternKind::kWhite:
      white_ = photo;
      break;
    case PatternKind::kBlack:
      black_ = photo;
      break;
    case PatternKind::kPhase:
      phases_.at(static_cast<std::size_t>(picture.axis)).add(picture.step, photo);
      break;
    case PatternKind::kLevel:
      break;
    case PatternKind::kBit:
      if (picture.is_inverse) {
        add_pair(picture, pattern_, photo);
        pattern_ = Photo();
      } else {
        pattern_ = photo;
      }
      break;
  }
  return Done{};
}

void Decoder::add_pair(const PatternPicture& picture, const Photo& pattern, const Photo& inverse) {
  AxisBits& axis = axes_.at(static_cast<std::size_t>(picture.axis));
  Difference& difference = axis.differences[static_cast<std::size_t>(picture.bit)];
  difference = Difference(width_px_, height_px_);
  const auto count = static_cast<float>(++pairs_);
  const int finest = separating_bit(axis);
  // All XORed stripes are as narrow as those of the base.
  const bool separates = set_.base_bit >= 0 ? picture.bit >= set_.base_bit
                                            : picture.bit >= finest && picture.bit < finest + kSeparatingBits;
  for (std::size_t i = 0; i < difference.data().size(); ++i) {
    const float a = pattern.data()[i];
    const float b = inverse.data()[i];
    difference.data()[i] = static_cast<std::int16_t>(std::lround(kDifferenceScale * std::clamp(a - b, -1.0f, 1.0f)));
    float& mean = sums_.data()[2 * i];
    const float off = a + b - mean;
    mean += off / count;
    sums_.data()[2 * i + 1] += off * (a + b - mean);
    if (separates) {
      min_.data()[i] = std::min({min_.data()[i], a, b});
      max_.data()[i] = std::max({max_.data()[i], a, b});
    }
  }
}

double Decoder::measured_noise(const Image<float, 1>& amplitude) const {
  // The sum of pattern and inverse should be constant, so the variance of the sum gives the noise. Only pixels that the
  // projector lights are used, since others are not decoded.
  std::vector<float> variances;
  const std::size_t count = amplitude.data().size();
  const std::size_t every = std::max<std::size_t>(1, count / 50000);
  for (std::size_t i = 0; i < count; i += every) {
    if (amplitude.data()[i] > 0.02f) variances.push_back(sums_.data()[2 * i + 1]);
  }
  if (variances.empty() || pairs_ < 2) return 0.0;
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return std::sqrt(static_cast<double>(*middle) / (pairs_ - 1) / 2.0);
}

void Decoder::judge_light(const DecodeSettings& settings, Decoded* decoded) const {
  const auto darkest = static_cast<float>(std::max(settings.darkest, 3.0 * decoded->noise));
  const auto saturated = static_cast<float>(settings.saturated);
  const auto min_share = static_cast<float>(settings.min_direct_share);
  for (std::size_t i = 0; i < white_.data().size(); ++i) {
    const float amplitude = std::max(0.0f, decoded->amplitude.data()[i]);
    const float direct = std::clamp(max_.data()[i] - min_.data()[i], 0.0f, 1e6f);
    decoded->direct_light.data()[i] = direct;
    decoded->global_light.data()[i] = std::clamp(2.0f * (min_.data()[i] - black_.data()[i]), 0.0f, 1e6f);
    const double spread =
        0.5 * std::sqrt(std::max(0.0, static_cast<double>(sums_.data()[2 * i + 1])) / std::max(1, pairs_ - 1));
    PixelFate& fate = decoded->fate.data()[i];
    if (white_.data()[i] >= saturated) {
      fate = PixelFate::kSaturated;
    } else if (direct < darkest || amplitude < darkest || direct < min_share * amplitude) {
      fate = PixelFate::kDark;
    } else if (spread > settings.disturbance * static_cast<double>(amplitude) + 2.0 * decoded->noise) {
      fate = PixelFate::kDisturbed;
    } else {
      fate = PixelFate::kDecoded;
    }
  }
}

Result<Decoded> Decoder::finish(const DecodeSettings& settings) const {
  if (next_ != set_.pictures.size()) {
    return bad(std::to_string(set_.pictures.size() - next_) + " photographs are missing; the next is " +
               name_of(set_.pictures[next_]));
  }
  Decoded decoded;
  decoded.amplitude = Image<float, 1>(width_px_, height_px_);
  for (std::size_t i = 0; i < white_.data().size(); ++i)
    decoded.amplitude.data()[i] = white_.data()[i] - black_.data()[i];
  decoded.noise = measured_noise(decoded.amplitude);
  decoded.direct_light = Image<float, 1>(width_px_, height_px_);
  decoded.global_light = Image<float, 1>(width_px_, height_px_);
  decoded.fate = Image<PixelFate, 1>(width_px_, height_px_);
  judge_light(settings, &decoded);
  Image<std::uint8_t, 1> is_lit(width_px_, height_px_);
  std::transform(decoded.fate.data().begin(), decoded.fate.data().end(), is_lit.data().begin(),
                 [](PixelFate fate) { return static_cast<std::uint8_t>(fate == PixelFate::kDecoded ? 1 : 0); });
  decoded.position_px = Image<float, 2>(width_px_, height_px_);
  decoded.sigma_px = Image<float, 2>(width_px_, height_px_);
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const AxisBits& axis = axes_.at(a);
    const StripeReading reading = read_bits(axis, decoded.amplitude, decoded.noise, settings.undecided);
    AxisPositions positions = interpolate_edges(axis, reading, decoded.amplitude, is_lit, decoded.noise);
    if (phases_.at(a).is_complete()) phases_.at(a).refine(decoded.noise, &positions);
    const auto extent = static_cast<float>(axis.extent_px);
    for (std::size_t i = 0; i < is_lit.data().size(); ++i) {
      if (decoded.fate.data()[i] != PixelFate::kDecoded) continue;
      const float position = positions.position_px.data()[i];
      const float sigma = positions.sigma_px.data()[i];
      if (sigma < 0.0f || sigma > static_cast<float>(settings.max_sigma_px) || position < 0.0f || position > extent) {
        decoded.fate.data()[i] = PixelFate::kUnstableBit;
        continue;
      }
      decoded.position_px.data()[2 * i + a] = position;
      decoded.sigma_px.data()[2 * i + a] = sigma;
    }
  }
  remove_small_patches(settings.min_patch_px, &decoded);
  bool is_any_lit = false;
  for (std::size_t i = 0; i < is_lit.data().size(); ++i) {
    is_any_lit |= decoded.fate.data()[i] != PixelFate::kDark;
    if (decoded.fate.data()[i] == PixelFate::kDecoded) continue;
    for (std::size_t a = 0; a < 2; ++a) {
      decoded.position_px.data()[2 * i + a] = 0.0f;
      decoded.sigma_px.data()[2 * i + a] = 0.0f;
    }
  }
  if (!is_any_lit) {
    return Error(ErrorCode::kBadData,
                 "the camera sees none of the projector's light: is the projector on, its cover off, and the camera "
                 "turned to its "
                 "picture? If so, expose longer");
  }
  return decoded;
}

}  // namespace cyclorama::structured_light
