// SPDX-License-Identifier: Apache-2.0
/// Samples of earlier pictures, carried to where their surfaces are seen now.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/panorama.h"
#include "common/image/pixel_rect.h"
#include "renderfarm/render/film.h"

namespace cyclorama {

/// Where from and where to a film looks. A value.
struct FilmView {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
  Panorama panorama;
  PixelRect rect;  ///< The film's part of the panorama.
};

/// The past of one stream of pictures: a film goes in, and comes out with the samples of earlier ones that saw the same
/// surfaces. It stands before the spatial filter, which does less the more samples there are.
///
/// 1. While the eye stays at its place nothing in the scene changes: samples add up, without a limit, to what one long
///    picture would have been. A turn by whole pixels is an exact shift; other turns interpolate as in 2.
/// 2. While it moves, a surface is found again by its place and its normal, between pixels by interpolation; its past
///    counts for at most `most_samples`, is taken into the range of the colours about it now (highlights move), and
///    counts the less the farther it was outside.
/// 3. What comes out depends on what this object saw before: with it, a block's picture is no longer the same on every
///    node and in every tiling. It is kept per node and per visit, and forgotten by clear().
///
/// Thread-bound. Source of 2: Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017, section 4.1; Salvi,
/// "An Excursion in Temporal Supersampling", GDC 2016 (the colours' range by mean and deviation).
class TemporalHistory {
 public:
  explicit TemporalHistory(int most_samples) : most_samples_(most_samples) {}

  /// The film with its past, which is also what is remembered. Its samples must be of other numbers than those before
  /// (RenderQuality::first_sample, or another seed). Precondition: the film has features and is of the size of
  /// view.rect.
  [[nodiscard]] Film accumulate(Film film, const FilmView& view);
  void clear() { past_.reset(); }

 private:
  struct Earlier {
    Film film;
    FilmView view;
  };
  int most_samples_;
  std::optional<Earlier> past_;
};

}  // namespace cyclorama
