// SPDX-License-Identifier: Apache-2.0
/// Refines a picture at rest, step by step, up to the reference quality.
#pragma once

#include <optional>
#include <vector>

#include "renderfarm/governor/front.h"

namespace cyclorama::governor {

/// A range of samples [first, end). cut_samples() divides a range into pieces; a picture is rendered and its samples
/// are added piece by piece. The cuts are at the powers of two up to `max` and at each multiple of `max`; an empty
/// range gives no pieces. Sums of floats depend on their order. With fixed cuts, a picture refined in steps that end at
/// cuts is bit-identical to a picture that another node renders at once. A piece is also the longest work in one cell
/// before a node notices an interruption, so pictures with many bounces have shorter pieces
/// (render::max_samples_per_piece()).
struct SampleRange {
  int first = 0;
  int end = 0;
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};
/// Returns the pieces of a range. Precondition: `max` is a power of two.
[[nodiscard]] std::vector<SampleRange> cut_samples(const SampleRange& range, int max);
/// Returns the pieces with cuts at multiples of `max` only, for pictures that are not refined in steps.
[[nodiscard]] std::vector<SampleRange> cut_evenly(const SampleRange& range, int max);

/// The refinement of one view from its first picture at rest to the reference:
///
///   nothing ──next(), done()──► some samples ──next(), done()──► ... ──► the reference: rests
///
/// The first picture has as many samples as it needs to be no worse than the moving picture. As long as a picture is
/// predicted to take less than a second, each has twice the samples of its predecessor, which halves the mean squared
/// error; after that, each takes about a second. If the moving picture uses stored light, it is the prior of the
/// picture at rest: it counts as the number of samples that have its error. The first picture then needs only one
/// traced sample and looks like the moving picture. Pure; thread-bound.
class Refinement {
 public:
  /// The picture with stored light with which a picture at rest begins:
  struct Prior {
    int samples = 0;      ///< Number of its samples; 0: there is no prior.
    double weight = 0.0;  ///< Number of path traced samples that have the same error.
  };

  /// Uses the front's best quality without the settings that would bias a reference: no denoiser, no firefly limit, no
  /// adaptive sampling, full size, no chroma subsampling, JPEG quality of at least 95. `moving` is the front's point of
  /// the previous picture; its error determines the number of samples of the first picture. Precondition: 1 <=
  /// reference_samples <= kMaxSamples.
  Refinement(const ParetoFront& front, const ParetoPoint& moving, int reference_samples);

  /// Returns the next range of samples; null once the reference is reached. `ms_per_sample` is the time of one sample
  /// of the whole picture, measured during an earlier rest; 0 if unknown.
  [[nodiscard]] std::optional<SampleRange> next(double ms_per_sample) const;
  /// Records that the picture with the samples up to `range.end` is displayed. Precondition: next() returned `range`.
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
