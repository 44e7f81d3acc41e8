// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/adaptive_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <limits>
#include <utility>

#include "common/base/cpu_time.h"
#include "renderfarm/light/light_store.h"
#include "renderfarm/light_baking/grid_pieces.h"
#include "renderfarm/render/flush_denormals.h"

namespace cyclorama::light_baking {
namespace {

constexpr std::size_t kTrianglesPerChunk = 128;
constexpr std::size_t kGridsPerChunk = 16;
/// Chunks in a piece: about a second of work.
constexpr std::size_t kProbeChunksPerPiece = 64;
constexpr std::size_t kGridChunksPerPiece = 16;
/// A round takes at most this share of what is left of the budget, so that the rest can follow what the round finds.
constexpr std::uint64_t kRoundShare = 3;
/// Shares of the reported progress: probing, then the steps.
constexpr double kProbingShare = 0.5;
constexpr double kStepsShare = 0.4;

struct Entry {
  std::size_t side = 0;
  GridInWork grid;
};

/// Returns the squared error that a step may remove, summed over visible samples, divided by the samples that it
/// stores.
double gain_of(const GridInWork& grid) {
  const double pixels = static_cast<double>(grid.max_parts) * static_cast<double>(grid.max_parts);
  return static_cast<double>(grid.squared_error) * pixels / static_cast<double>(grid.step_samples());
}

class GridSpender {
 public:
  GridSpender(std::span<const SeenSide> sides, const BakeSettings& settings, const GridBudget& budget,
              LightTracers& tracers, StageChain& stages)
      : sides_(sides), settings_(settings), budget_(budget), tracers_(tracers), stages_(stages), left_(budget.samples) {
    settings_.max_grid_light_rays = settings_.rays_of(settings_.max_grid_light_rays, budget.samples, 1);
  }

  Result<std::vector<SideGrids>> run() {
    TRY(probe());
    TRY(spend(budget_.samples, [](const GridInWork&) { return true; }));
    TRY(spend(budget_.resolving_samples, [](const GridInWork& grid) { return grid.is_unresolved(); }));
    return finish();
  }

 private:
  [[nodiscard]] bool is_over() const { return budget_.is_over && budget_.is_over(); }
  [[nodiscard]] Status check_cancelled() const { return budget_.check_cancelled ? budget_.check_cancelled() : Done{}; }
  void report(double fraction) const {
    if (budget_.report_progress) budget_.report_progress(fraction);
  }
  [[nodiscard]] std::size_t triangles_of(std::size_t side) const {
    return sides_[side].lit.placement->mesh->triangle_count;
  }

  /// Calls work(index, tracer) for the items of a piece, in parallel, several by one task. Errors: kUnavailable if that
  /// was cancelled.
  template <typename Work>
  [[nodiscard]] Status for_items(std::size_t first, std::size_t end, std::size_t per_chunk, Work work) {
    tbb::parallel_for(std::size_t{0}, (end - first + per_chunk - 1) / per_chunk, [&](std::size_t chunk) {
      if (!check_cancelled()) return;
      const double before = thread_cpu_seconds();
      const render::FlushDenormals flush;
      LightTracer& tracer = *tracers_.local();
      tracer.begin_run();
      const std::size_t chunk_end = std::min(first + (chunk + 1) * per_chunk, end);
      for (std::size_t i = first + chunk * per_chunk; i < chunk_end && !tracer.must_end(); ++i) work(i, tracer);
      tracer.must_end();
      if (budget_.add_cpu_seconds) budget_.add_cpu_seconds(thread_cpu_seconds() - before);
    });
    return check_cancelled();
  }

  /// Triangles that are probed together.
  struct ProbedChunk {
    std::size_t side = 0;
    std::span<const SeenTriangle> triangles;
    std::vector<GridInWork> found{};
  };

  [[nodiscard]] Status probe() {
    std::vector<ProbedChunk> chunks;
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      const std::span triangles = sides_[s].triangles;
      for (std::size_t first = 0; first < triangles.size(); first += kTrianglesPerChunk) {
        chunks.push_back({s, triangles.subspan(first, std::min(kTrianglesPerChunk, triangles.size() - first))});
      }
    }
    const PieceCut cut(chunks.size(), kProbeChunksPerPiece);
    std::atomic<std::uint32_t> taken = 0;
    StageWork work;
    work.compute = [&](std::uint32_t piece) -> Result<PieceBytes> {
      const std::size_t first = cut.first(piece);
      std::vector<std::vector<GridInWork>> found(cut.end(piece) - first);
      TRY(for_items(first, cut.end(piece), 1, [&](std::size_t i, LightTracer& tracer) {
        if (is_over()) return;
        found[i - first] = probe_triangles(sides_[chunks[i].side].lit, chunks[i].triangles, settings_, tracer);
      }));
      PieceWriter out;
      for (const std::vector<GridInWork>& part : found) {
        out.add(static_cast<std::uint32_t>(part.size()));
        for (const GridInWork& grid : part) add(grid, &out);
      }
      return out.take();
    };
    work.take = [&](std::uint32_t piece, std::span<const std::byte> bytes) -> Status {
      PieceReader in(bytes);
      for (std::size_t i = cut.first(piece); i < cut.end(piece); ++i) {
        chunks[i].found.resize(in.read_count(kMinGridBytes));
        for (GridInWork& grid : chunks[i].found) {
          TRY_ASSIGN(grid, read_grid_in_work(&in, triangles_of(chunks[i].side)));
        }
      }
      TRY(in.finished());
      report(kProbingShare * static_cast<double>(++taken) / static_cast<double>(cut.pieces()));
      return Done{};
    };
    TRY(stages_.complete(cut.pieces(), std::move(work)));
    for (ProbedChunk& chunk : chunks) {
      for (GridInWork& grid : chunk.found) entries_.push_back({chunk.side, std::move(grid)});
    }
    return Done{};
  }

  [[nodiscard]] std::uint64_t used_samples() const {
    std::uint64_t used = 0;
    for (const Entry& entry : entries_) used += entry.grid.light.size();
    return used;
  }

  /// Performs steps of grids that may(grid), until all grids together have `samples` or want no more.
  template <typename May>
  [[nodiscard]] Status spend(std::uint64_t samples, May may) {
    left_ = samples - std::min(samples, used_samples());
    for (bool is_done = false; left_ > 0 && !is_over() && !is_done;) {
      TRY_ASSIGN(const bool has_stepped, step(may));
      is_done = !has_stepped;
      left_ = samples - used_samples();  // A step that improved nothing has stored nothing.
      if (samples ==
          budget_.samples) {  // The rest is rarely used, and how much of it is needed is not known in advance.
        report(kProbingShare + kStepsShare * (1.0 - static_cast<double>(left_) / static_cast<double>(samples)));
      }
    }
    return Done{};
  }

  /// Performs the best steps that fit. Returns false if there were none.
  template <typename May>
  [[nodiscard]] Result<bool> step(May may) {
    std::vector<std::pair<double, std::size_t>> wanted;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const GridInWork& grid = entries_[i].grid;
      if (grid.wants_step() && may(grid)) wanted.emplace_back(gain_of(grid), i);
    }
    std::ranges::sort(wanted, [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<std::size_t> chosen;
    std::uint64_t taken = 0;
    for (const auto& [gain, i] : wanted) {
      const auto samples = static_cast<std::uint64_t>(entries_[i].grid.step_samples());
      if (taken + samples > left_) continue;
      taken += samples;
      chosen.push_back(i);
      if (taken >= left_ / kRoundShare) break;
    }
    TRY(advance(chosen));
    return !chosen.empty();
  }

  [[nodiscard]] Status advance(std::span<const std::size_t> chosen) {
    const PieceCut cut(chosen.size(), kGridsPerChunk * kGridChunksPerPiece);
    StageWork work;
    work.compute = [&](std::uint32_t piece) -> Result<PieceBytes> {
      const std::size_t first = cut.first(piece);
      std::vector<GridInWork> grids;
      for (std::size_t k = first; k < cut.end(piece); ++k) grids.push_back(entries_[chosen[k]].grid);
      TRY(for_items(first, cut.end(piece), kGridsPerChunk, [&](std::size_t k, LightTracer& tracer) {
        if (!is_over()) advance_grid(sides_[entries_[chosen[k]].side].lit, settings_, tracer, &grids[k - first]);
      }));
      PieceWriter out;
      for (const GridInWork& grid : grids) add(grid, &out);
      return out.take();
    };
    work.take = [&](std::uint32_t piece, std::span<const std::byte> bytes) -> Status {
      PieceReader in(bytes);
      std::vector<GridInWork> grids;
      for (std::size_t k = cut.first(piece); k < cut.end(piece); ++k) {
        TRY_ASSIGN(GridInWork grid, read_grid_in_work(&in, triangles_of(entries_[chosen[k]].side)));
        grids.push_back(std::move(grid));
      }
      TRY(in.finished());
      // Only a whole piece is kept: computing it again begins with the grids of before.
      for (std::size_t k = cut.first(piece); k < cut.end(piece); ++k)
        entries_[chosen[k]].grid = std::move(grids[k - cut.first(piece)]);
      return Done{};
    };
    return stages_.complete(cut.pieces(), std::move(work));
  }

  [[nodiscard]] Result<std::vector<SideGrids>> finish() {
    std::vector<SideGrids> sides(sides_.size());
    for (const Entry& entry : entries_) {
      if (entry.grid.is_unresolved()) sides[entry.side].unresolved.push_back(entry.grid.triangle);
    }
    std::erase_if(entries_, [](const Entry& entry) { return entry.grid.parts == 0 || entry.grid.is_unresolved(); });
    BakeSettings settings = settings_;
    std::uint64_t samples = 0;
    for (const Entry& entry : entries_) {
      samples += static_cast<std::uint64_t>(light::TriangleGrid::samples(entry.grid.surface_parts()));
    }
    settings.final_rays = settings.rays_of(settings.final_rays, samples, 1);
    // The remaining samples are divided among the uneven triangles, so that the order of the threads does not matter.
    const auto uneven = static_cast<std::uint64_t>(
        std::ranges::count_if(entries_, [](const Entry& entry) { return entry.grid.is_uneven(); }));
    const std::uint64_t share = left_ / std::max<std::uint64_t>(uneven, 1);
    std::vector<MadeGrid> made(entries_.size());
    const PieceCut cut(made.size(), kGridsPerChunk * kGridChunksPerPiece);
    StageWork work;
    work.compute = [&](std::uint32_t piece) -> Result<PieceBytes> {
      const std::size_t first = cut.first(piece);
      std::vector<MadeGrid> grids(cut.end(piece) - first);
      TRY(for_items(first, cut.end(piece), kGridsPerChunk, [&](std::size_t k, LightTracer& tracer) {
        const GridInWork& grid = entries_[k].grid;
        const auto max_samples = static_cast<int>(grid.light.size() + share);
        grids[k - first] = finished_grid(sides_[entries_[k].side].lit, grid, max_samples, settings, tracer);
      }));
      PieceWriter out;
      for (const MadeGrid& grid : grids) add(grid, &out);
      return out.take();
    };
    work.take = [&](std::uint32_t piece, std::span<const std::byte> bytes) -> Status {
      PieceReader in(bytes);
      for (std::size_t k = cut.first(piece); k < cut.end(piece); ++k) {
        TRY_ASSIGN(made[k], read_made_grid(&in, triangles_of(entries_[k].side)));
      }
      return in.finished();
    };
    TRY(stages_.complete(cut.pieces(), std::move(work)));
    for (std::size_t k = 0; k < made.size(); ++k) sides[entries_[k].side].grids.push_back(std::move(made[k]));
    report(1.0);
    return sides;
  }

  const std::span<const SeenSide> sides_;
  BakeSettings settings_;
  const GridBudget& budget_;
  LightTracers& tracers_;
  StageChain& stages_;
  std::uint64_t left_;
  std::vector<Entry> entries_;
};

}  // namespace

Result<std::vector<SideGrids>> make_grids(std::span<const SeenSide> sides, const BakeSettings& settings,
                                          const GridBudget& budget, LightTracers& tracers, StageChain& stages) {
  return GridSpender(sides, settings, budget, tracers, stages).run();
}

}  // namespace cyclorama::light_baking
