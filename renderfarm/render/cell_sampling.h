// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/kernel.h"

namespace cyclorama {

/// All samples that the view's quality asks for in a cell, added to `film`. With adaptive sampling, pixels stop when
/// the error that is seen there, and around them, is small enough: standard error of the displayed luminance, its
/// largest value among the eight neighbours of the cell too, so that a pixel whose few samples happen to agree goes on
/// beside one whose do not; never before the minimum. Returns the number of rays. Reentrant; `batch` is scratch.
std::uint64_t sample_cell(const TraceScene& scene, ShadeStage shade, const TraceView& view, const TraceCell& cell,
                          PathBatch& batch, CellFilm& film);

/// Which pixels of the cell still want samples, into film.active. Returns whether any does.
bool find_active(const TraceView& view, const TraceCell& cell, CellFilm& film);

}  // namespace cyclorama
