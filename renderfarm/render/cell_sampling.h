// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/kernel.h"

namespace cyclorama::render {

/// Adds to `film` all samples of a cell that the view's quality requests. With adaptive sampling, a pixel stops once
/// the estimated error is small enough: the standard error of displayed luminance, at its maximum over the pixel and
/// its eight neighbours in the cell. A pixel whose few samples agree by chance thus continues beside a noisy one. No
/// pixel stops before the minimum. Returns the number of rays. Reentrant; `batch` is scratch.
std::uint64_t sample_cell(const TraceScene& scene, ShadeStage shade, const TraceView& view, const TraceCell& cell,
                          PathBatch& batch, CellFilm& film);

/// Marks in film.active the pixels of the cell whose displayed luminance differs from a neighbour's by more than a few
/// codes (edges and fine texture), and those that lack stored light. Returns whether there are any. Source: Mitchell,
/// "Generating Antialiased Images at Low Sampling Densities", 1987.
bool find_contrast(const TraceView& view, const TraceCell& cell, CellFilm& film);

/// Marks in film.active the pixels of the cell that need more samples. Returns whether there are any.
bool find_active(const TraceView& view, const TraceCell& cell, CellFilm& film);

}  // namespace cyclorama::render
