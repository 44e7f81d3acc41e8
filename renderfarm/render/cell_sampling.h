// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/kernel.h"

namespace cyclorama::render {

/// Adds to `film` all samples of a cell that the view's quality requests. With adaptive sampling, a pixel gets no more
/// samples once the standard error of displayed luminance is small enough for the pixel and for its eight neighbours in
/// the cell. A pixel whose first samples agree by chance thus gets more samples if a neighbour is noisy. Every pixel
/// gets at least RenderQuality::adaptive_minimum samples. Returns the number of rays. Reentrant; `batch` is scratch.
std::uint64_t sample_cell(const TraceScene& scene, ShadeStage shade, const TraceView& view, const TraceCell& cell,
                          PathBatch& batch, CellFilm& film);

/// Marks in film.active the pixels of the cell whose displayed luminance differs from a neighbour's by more than a few
/// codes (edges and fine texture), and those that lack stored light. Returns true if any pixel is marked. Source:
/// Mitchell, "Generating Antialiased Images at Low Sampling Densities", 1987.
bool find_contrast(const TraceView& view, const TraceCell& cell, CellFilm& film);

/// Marks in film.active the pixels of the cell that need more samples. Returns true if any pixel is marked.
bool find_active(const TraceView& view, const TraceCell& cell, CellFilm& film);

}  // namespace cyclorama::render
