// SPDX-License-Identifier: Apache-2.0
/// Refines a picture at rest, step by step, up to the reference.
#pragma once

#include <optional>
#include <vector>

#include "renderfarm/governor/front.h"

namespace cyclorama::governor {

/// A range of samples [first, end). cut_samples() divides a range into the pieces in which samples are rendered and
/// added, with cuts at the powers of two up to `max` and at each multiple of `max`; an empty range gives none. Float
/// sums depend on their order: with fixed cuts, a picture refined in steps is bit-identical to one that another node renders at once,
/// provided that the steps end at cuts. A piece is also the longest work in one cell before a node notices an
/// interruption, so a picture of many bounces has shorter ones (render::max_samples_per_piece()).
struct SampleRange {
  int first = 0;
  int end = 0;
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};
/// Precondition: `max` is a power of two.
[[nodiscard]] std::vector<SampleRange> cut_samples(const SampleRange& range, int max);
/// Returns the same cuts at multiples of `max` alone, for pictures that are not refined in steps.
[[nodiscard]] std::vector<SampleRange> cut_evenly(const SampleRange& range, int max);

/// The refinement of one view from its first picture at rest to the reference:
///
///   nothing ──next(), done()──► some samples ──next(), done()──► ... ──► the reference: rests
///
/// The first picture has as many samples as it needs to be no worse than the moving one. Then each has twice the
/// samples of the one before, which halves the mean squared error, while a picture is predicted to take less than a
/// second; after that, each takes about a second. A moving picture that reads stored light is the prior of the
/// one at rest: it counts as the number of samples with its error, so the first picture needs one sample of its own and
/// looks like the moving one. Pure; thread-bound.
class Refinement {
 public:
  /// The picture with stored light with which a picture at rest begins.
  struct Prior {
    int samples = 0;      ///< Its samples; 0: there is none.
    double weight = 0.0;  ///< Path traced samples that are as exact.
  };

  /// Uses the front's best quality without what would bias a reference: no denoiser, no firefly limit, no adaptive
  /// sampling, full size, no chroma subsampling, JPEG quality of at least 95. `moving` is the point of the previous
  /// picture, taken from the front; its error determines the number of samples of the first picture. Precondition: 1 <=
  /// reference_samples <= kMaxSamples.
  Refinement(const ParetoFront& front, const ParetoPoint& moving, int reference_samples);

  /// Returns the next samples; null once the reference is reached. `ms_per_sample` applies to the whole picture and
  /// comes from an earlier rest; 0 if unknown.
  [[nodiscard]] std::optional<SampleRange> next(double ms_per_sample) const;
  /// Records that the picture of the samples up to `range.end` is displayed. Precondition: next() returned `range`.
  void done(const SampleRange& range);

  [[nodiscard]] const render::PictureQuality& quality() const { return quality_; }
  [[nodiscard]] const Prior& prior() const { return prior_; }
  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] int reference_samples() const { return quality_.render.sequence; }
  [[nodiscard]] bool rests() const { return samples_ == reference_samples(); }

 private:
  render::PictureQuality quality_;
  Prior prior_;
  int first_picture_ = 1;
  int samples_ = 0;
};

}  // namespace cyclorama::governor
