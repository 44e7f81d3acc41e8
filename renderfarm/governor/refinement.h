// SPDX-License-Identifier: Apache-2.0
/// What a picture at rest still lacks.
#pragma once

#include <optional>
#include <vector>

#include "renderfarm/governor/front.h"

namespace cyclorama {

/// Samples [first, end) in the pieces in which they are rendered and added: at 1, 2, 4, 8, 16, 32, and each multiple of
/// 64. Sums of floats depend on their order; so cut, a picture that was refined in steps is bit-identical to one that
/// another node renders at once, as long as the steps end at these cuts, too. A piece of 64 is also how long a node
/// may go on in one cell before it sees that it was cancelled. None for an empty range.
struct SampleRange {
  int first = 0;
  int end = 0;
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};
[[nodiscard]] std::vector<SampleRange> cut_samples(const SampleRange& range);

/// The way of one view from its first picture at rest to the reference:
///
///   nothing ──next(), done()──► some samples ──next(), done()──► ... ──► the reference: rests
///
/// The first picture has as many samples as it needs to be no worse than the moving one; then each has twice the
/// samples of the one before, so the mean squared error halves from picture to picture, while a picture is predicted to
/// take less than a second; then each takes about a second. Pure; thread-bound.
class Refinement {
 public:
  /// The quality is the front's best one without what makes a reference wrong: no denoiser, no limit to fireflies, no
  /// adaptive stop, full size, all of its colours, JPEG of 95 or more. `moving`: the point of the picture before, one
  /// of the front's; its error decides how many samples come first. Precondition: 1 <= reference_samples <=
  /// kMostSamples.
  Refinement(const Front& front, const FrontPoint& moving, int reference_samples);

  /// The samples that come next; nothing when the reference is reached. `ms_per_sample`, of the whole picture, from an
  /// earlier rest; 0 when it is not known.
  [[nodiscard]] std::optional<SampleRange> next(double ms_per_sample) const;
  /// The picture of the samples up to `range.end` is shown. Precondition: next() gave it.
  void done(const SampleRange& range);

  [[nodiscard]] const PictureQuality& quality() const { return quality_; }
  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] int reference_samples() const { return quality_.render.sequence; }
  [[nodiscard]] bool rests() const { return samples_ == reference_samples(); }

 private:
  PictureQuality quality_;
  int first_picture_ = 1;
  int samples_ = 0;
};

}  // namespace cyclorama
