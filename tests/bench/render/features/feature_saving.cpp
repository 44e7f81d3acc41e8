// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/features/feature_saving.h"

#include <algorithm>

#include "tests/bench/render/features/instruction_counter.h"

namespace cyclorama {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One kernel, and its cost in each repetition.
struct Candidate {
  render::SurfaceLevel kernel = render::SurfaceLevel::kMatte;
  std::vector<double> ns_per_ray;
  std::vector<double> instructions_per_ray;  ///< Empty if they cannot be counted.

  [[nodiscard]] KernelCost cost() const {
    KernelCost cost{.ns_per_ray = median(ns_per_ray), .instructions_per_ray = std::nullopt};
    if (!instructions_per_ray.empty()) cost.instructions_per_ray = median(instructions_per_ray);
    return cost;
  }
};

double saving(const std::vector<double>& own, const std::vector<double>& other) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < own.size(); ++i) ratios.push_back(own[i] / other[i]);
  return 1.0 - median(std::move(ratios));
}

/// Returns the scene's own kernel, then those for the levels above it.
std::vector<Candidate> candidates_of(render::SurfaceLevel own) {
  using enum render::SurfaceLevel;
  std::vector<Candidate> candidates;
  for (const render::SurfaceLevel level : {kMatte, kGlossy, kLayered}) {
    if (level >= own) candidates.push_back({level, {}, {}});
  }
  return candidates;
}

Result<std::uint64_t> run(const render::Renderer& renderer, const render::PanoramaView& view,
                          const InstructionCounter* counter, const std::function<bool()>& cancelled,
                          Candidate* candidate) {
  const Panorama& panorama = view.panorama;
  const auto counted = [&] { return counter != nullptr ? counter->count() : Result<std::uint64_t>(0); };
  render::Film film;
  TRY_ASSIGN(const std::uint64_t before, counted());
  const render::RenderCost cost =
      renderer.render_film(view, {0, 0, panorama.width_px, panorama.height_px}, false, &film, cancelled);
  TRY_ASSIGN(const std::uint64_t after, counted());
  if (cancelled && cancelled()) return Error(ErrorCode::kUnavailable, "stopped before it was done");
  const auto rays = static_cast<double>(std::max<std::uint64_t>(cost.rays, 1));
  candidate->ns_per_ray.push_back(1e9 * cost.cpu_seconds / rays);
  if (counter != nullptr) candidate->instructions_per_ray.push_back(static_cast<double>(after - before) / rays);
  return cost.rays;
}

FeatureSaving saving_of(const Candidate& own, const Candidate& other) {
  FeatureSaving saved;
  saved.kernel = other.kernel;
  saved.cost = other.cost();
  saved.time_saving = saving(own.ns_per_ray, other.ns_per_ray);
  if (!own.instructions_per_ray.empty()) {
    saved.instruction_saving = saving(own.instructions_per_ray, other.instructions_per_ray);
  }
  return saved;
}

}  // namespace

Result<FeatureReport> measure_features(render::Renderer* renderer, const render::PanoramaView& view, int repetitions,
                                       const std::function<bool()>& cancelled) {
  const Result<InstructionCounter> counter = InstructionCounter::open();
  FeatureReport report;
  report.kernel = renderer->surface_level();
  std::vector<Candidate> candidates = candidates_of(report.kernel);
  for (int i = 0; i < std::max(1, repetitions); ++i) {
    for (Candidate& candidate : candidates) {
      renderer->use_kernel_for(candidate.kernel);
      TRY_ASSIGN(report.rays, run(*renderer, view, counter ? &*counter : nullptr, cancelled, &candidate));
    }
    std::reverse(candidates.begin(), candidates.end());
  }
  renderer->use_kernel_for(report.kernel);
  if (repetitions % 2 != 0) std::reverse(candidates.begin(), candidates.end());
  const Candidate& own = candidates.front();
  report.cost = own.cost();
  for (std::size_t i = 1; i < candidates.size(); ++i) report.savings.push_back(saving_of(own, candidates[i]));
  return report;
}

}  // namespace cyclorama
