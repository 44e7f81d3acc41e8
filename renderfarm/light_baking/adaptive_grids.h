// SPDX-License-Identifier: Apache-2.0
/// Spends a budget of samples on the grids that gain most from them. The next step goes to the triangle for which the
/// product of its error and the pixels that it covers falls most per sample.
///
///     probe all triangles ──► steps that fit the budget, best first ──► measure their error ─┐
///                                     ▲                                                      │
///                                     └──────────────── until nothing is left ◄──────────────┘
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "renderfarm/light_baking/stage_chain.h"
#include "renderfarm/light_baking/triangle_grids.h"

namespace cyclorama::light_baking {

/// One tracer per thread, made when the thread first needs it.
using LightTracers = tbb::enumerable_thread_specific<std::unique_ptr<LightTracer>>;

/// A side, and the triangles of it that visitors see.
struct SeenSide {
  LitSide lit;
  std::span<const SeenTriangle> triangles;
};

/// Limits for all grids together.
struct GridBudget {
  std::uint64_t samples = 0;
  /// Samples that there may be if those beyond `samples` are on triangles which would be unresolved without them.
  std::uint64_t resolving_samples = 0;
  std::function<bool()> is_over{};                ///< Returns true once the time is up; may be null.
  std::function<Status()> check_cancelled{};      ///< Returns an error once the result is of no use; may be null.
  std::function<void(double)> add_cpu_seconds{};  ///< Called from any thread after each piece of work; may be null.
  std::function<void(double)> report_progress{};  ///< Receives a fraction in [0, 1]; may be null.
};

struct SideGrids {
  std::vector<MadeGrid> grids{};
  /// Triangles that cover much of a picture and need more than their vertices, but for which neither budget sufficed.
  std::vector<std::uint32_t> unresolved{};
};

/// Returns the grids of each side, ordered by triangle. Probing, each round of steps and the end are stages. Uses the
/// threads of the TBB arena in which it is called; the result does not depend on their number unless `is_over` ended
/// it. Errors: as StageChain::complete().
[[nodiscard]] Result<std::vector<SideGrids>> make_grids(std::span<const SeenSide> sides, const BakeSettings& settings,
                                                        const GridBudget& budget, LightTracers& tracers,
                                                        StageChain& stages);

}  // namespace cyclorama::light_baking
