// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/refinement.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/base/check.h"

namespace cyclorama::governor {
namespace {

constexpr int kPiece = 64;
constexpr double kMaxPictureMs = 1000.0;
/// The size of pictures at rest does not matter, because at most a dozen are sent per rest.
constexpr int kReferenceJpegQuality = 95;

int cut_after(int samples, int max = kPiece) {
  if (samples == 0) return 1;
  if (samples < max) return static_cast<int>(std::bit_ceil(static_cast<unsigned>(samples) + 1));
  return (samples / max + 1) * max;
}

/// Returns the first cut at or after `samples`.
int cut_at_least(double samples, int max) {
  int cut = 1;
  while (cut < max && cut < samples) cut = cut_after(cut);
  return std::min(cut, max);
}

/// Returns the error of one path traced sample at full size, from the front's most efficient point of this kind.
/// Assumes that errors are inversely proportional to samples. Infinite if the front has no such point.
double error_of_one_sample(const ParetoFront& front) {
  double error = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < front.size(); ++i) {
    const render::PictureQuality& quality = front[i].quality;
    if (quality.scale < 1.0 || quality.denoise || quality.render.stored_light) continue;
    error = std::min(error, front[i].error * quality.render.samples);
  }
  return error;
}

/// Returns the number of samples, at full size and without denoiser, whose error is at most that of `moving`.
double samples_as_good_as(const ParetoFront& front, const ParetoPoint& moving) {
  const double as_good = error_of_one_sample(front) / moving.error;
  const double more = 2.0 * moving.quality.render.samples;
  return std::isfinite(as_good) ? std::max(as_good, more) : more;
}

/// Returns the front's best picture with stored light, as a prior.
Refinement::Prior prior_of(const ParetoFront& front) {
  Refinement::Prior prior;
  const double error_of_one = error_of_one_sample(front);
  for (std::size_t i = 0; i < front.size(); ++i) {
    const render::PictureQuality& quality = front[i].quality;
    if (!quality.render.stored_light || quality.scale < 1.0 || quality.denoise || front[i].error <= 0.0) continue;
    const double weight = error_of_one / front[i].error;
    if (std::isfinite(weight)) prior = {quality.render.samples, std::min(weight, render::kMaxRadianceLimit)};
  }
  return prior;
}

}  // namespace

std::vector<SampleRange> cut_samples(const SampleRange& range, int max) {
  CHECK(max >= 1 && max <= kPiece && std::has_single_bit(static_cast<unsigned>(max)));
  std::vector<SampleRange> pieces;
  for (int at = range.first; at < range.end;) {
    const int next = std::min(range.end, cut_after(at, max));
    pieces.push_back({at, next});
    at = next;
  }
  return pieces;
}

std::vector<SampleRange> cut_evenly(const SampleRange& range, int max) {
  CHECK(max >= 1);
  std::vector<SampleRange> pieces;
  for (int at = range.first; at < range.end; at += max) pieces.push_back({at, std::min(range.end, at + max)});
  return pieces;
}

Refinement::Refinement(const ParetoFront& front, const ParetoPoint& moving, int reference_samples)
    : quality_(front.best().quality), prior_(prior_of(front)) {
  CHECK(reference_samples >= 1 && reference_samples <= render::kMaxSamples);
  quality_.scale = 1.0;
  quality_.denoise = false;
  quality_.jpeg_quality = std::max(quality_.jpeg_quality, kReferenceJpegQuality);
  quality_.subsample_chroma = false;
  quality_.render.firefly_limit = 0.0f;
  quality_.render.stored_light = false;
  quality_.render.adaptive_error = 0.0f;
  quality_.render.sequence = reference_samples;
  first_picture_ = prior_.samples > 0 ? 1 : cut_at_least(samples_as_good_as(front, moving), reference_samples);
}

std::optional<SampleRange> Refinement::next(double ms_per_sample) const {
  if (rests()) return std::nullopt;
  if (samples_ == 0) return SampleRange{0, first_picture_};
  const double affordable = ms_per_sample > 0.0 ? kMaxPictureMs / ms_per_sample : kPiece;
  const double wanted = samples_ + std::min<double>(samples_, affordable);
  return SampleRange{samples_, std::max(cut_at_least(wanted, reference_samples()),
                                        std::min(cut_after(samples_), reference_samples()))};
}

void Refinement::done(const SampleRange& range) {
  CHECK(range.first == samples_ && range.end > range.first && range.end <= reference_samples());
  samples_ = range.end;
}

}  // namespace cyclorama::governor
