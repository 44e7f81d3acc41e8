// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/adaptive_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "common/base/cpu_time.h"
#include "renderfarm/render/flush_denormals.h"

namespace cyclorama::light_baking {
namespace {

constexpr std::size_t kTrianglesPerChunk = 128;
constexpr std::size_t kGridsPerChunk = 16;
/// A round ends once it has taken 1/kRoundShare of the remaining budget, so that later rounds can use its results.
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
              LightTracers& tracers)
      : sides_(sides), settings_(settings), budget_(budget), tracers_(tracers), left_(budget.samples) {}

  std::vector<SideGrids> run() {
    probe();
    while (left_ > 0 && !is_over() && step()) {
      report(kProbingShare + kStepsShare * (1.0 - static_cast<double>(left_) / static_cast<double>(budget_.samples)));
    }
    return finish();
  }

 private:
  [[nodiscard]] bool is_over() const { return budget_.is_over && budget_.is_over(); }
  void report(double fraction) const {
    if (budget_.report_progress) budget_.report_progress(fraction);
  }

  /// Calls work(chunk number, tracer) in parallel.
  template <typename Work>
  void for_chunks(std::size_t count, std::size_t per_chunk, Work work) {
    tbb::parallel_for(std::size_t{0}, (count + per_chunk - 1) / per_chunk, [&](std::size_t chunk) {
      if (is_over()) return;
      const double before = thread_cpu_seconds();
      const render::FlushDenormals flush;
      work(chunk, *tracers_.local());
      if (budget_.add_cpu_seconds) budget_.add_cpu_seconds(thread_cpu_seconds() - before);
    });
  }

  void probe() {
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      const SeenSide& side = sides_[s];
      std::vector<std::vector<GridInWork>> found((side.triangles.size() + kTrianglesPerChunk - 1) / kTrianglesPerChunk);
      for_chunks(side.triangles.size(), kTrianglesPerChunk, [&](std::size_t chunk, LightTracer& tracer) {
        const std::size_t first = chunk * kTrianglesPerChunk;
        const std::size_t count = std::min(kTrianglesPerChunk, side.triangles.size() - first);
        found[chunk] = probe_triangles(side.lit, side.triangles.subspan(first, count), settings_, tracer);
      });
      for (std::vector<GridInWork>& part : found) {
        for (GridInWork& grid : part) entries_.push_back({s, std::move(grid)});
      }
      report(kProbingShare * static_cast<double>(s + 1) / static_cast<double>(sides_.size()));
    }
  }

  /// Performs the best steps that fit the budget. Returns false if there are none.
  bool step() {
    std::vector<std::pair<double, std::size_t>> wanted;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (entries_[i].grid.wants_step()) wanted.emplace_back(gain_of(entries_[i].grid), i);
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
    for_chunks(chosen.size(), kGridsPerChunk, [&](std::size_t chunk, LightTracer& tracer) {
      const std::size_t end = std::min((chunk + 1) * kGridsPerChunk, chosen.size());
      for (std::size_t k = chunk * kGridsPerChunk; k < end; ++k) {
        Entry& entry = entries_[chosen[k]];
        advance_grid(sides_[entry.side].lit, settings_, tracer, &entry.grid);
      }
    });
    std::uint64_t used = 0;
    for (const Entry& entry : entries_) used += entry.grid.light.size();
    left_ = budget_.samples - used;  // A step that improved nothing has stored nothing.
    return !chosen.empty();
  }

  std::vector<SideGrids> finish() {
    std::vector<SideGrids> sides(sides_.size());
    for (const Entry& entry : entries_) {
      if (entry.grid.is_unresolved()) sides[entry.side].unresolved.push_back(entry.grid.triangle);
    }
    std::erase_if(entries_, [](const Entry& entry) { return entry.grid.parts == 0 || entry.grid.is_unresolved(); });
    std::vector<MadeGrid> made(entries_.size());
    tbb::parallel_for(std::size_t{0}, (entries_.size() + kGridsPerChunk - 1) / kGridsPerChunk, [&](std::size_t chunk) {
      const double before = thread_cpu_seconds();
      const render::FlushDenormals flush;
      for (std::size_t k = chunk * kGridsPerChunk; k < std::min((chunk + 1) * kGridsPerChunk, made.size()); ++k) {
        made[k] = finished_grid(sides_[entries_[k].side].lit, entries_[k].grid, settings_, *tracers_.local());
      }
      if (budget_.add_cpu_seconds) budget_.add_cpu_seconds(thread_cpu_seconds() - before);
    });
    for (std::size_t k = 0; k < made.size(); ++k) sides[entries_[k].side].grids.push_back(std::move(made[k]));
    report(1.0);
    return sides;
  }

  const std::span<const SeenSide> sides_;
  const BakeSettings& settings_;
  const GridBudget& budget_;
  LightTracers& tracers_;
  std::uint64_t left_;
  std::vector<Entry> entries_;
};

}  // namespace

std::vector<SideGrids> make_grids(std::span<const SeenSide> sides, const BakeSettings& settings,
                                  const GridBudget& budget, LightTracers& tracers) {
  return GridSpender(sides, settings, budget, tracers).run();
}

}  // namespace cyclorama::light_baking
