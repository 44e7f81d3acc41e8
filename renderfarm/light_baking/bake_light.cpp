// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/bake_light.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

#include "renderfarm/light_baking/bake_group.h"
#include "renderfarm/light_baking/check_light.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::light_baking {
namespace {

/// Share of the progress that is reported before the check.
constexpr double kBakingShare = 0.85;

/// Adds the light of a named group of lamps, and its cost.
void add_group(const BakedLight& group, BakedLight* baked) {
  const auto store = std::make_shared<light::LightStore>(*baked->store);
  light::LightStore& added = store->groups.emplace_back();
  added.unit = group.store->unit;
  added.surfaces = group.store->surfaces;
  baked->store = store;
  baked->cpu_seconds += group.cpu_seconds;
  baked->grids += group.grids;
  baked->separate_samples += group.separate_samples;
  baked->max_run_seconds = std::max(baked->max_run_seconds, group.max_run_seconds);
  for (const BakeStage& stage : group.stages) {
    const auto known = std::ranges::find(baked->stages, stage.name, &BakeStage::name);
    if (known == baked->stages.end()) {
      baked->stages.push_back(stage);
    } else {
      known->cpu_seconds += stage.cpu_seconds;
    }
  }
}

/// Adds the measured errors of the light to the store.
Status add_check(render::Renderer& renderer, int eyes, const std::function<void(double)>& progress,
                 const std::function<bool()>& cancelled, StageChain& stages, BakedLight* baked) {
  CheckSettings settings;
  settings.eyes = eyes;
  TRY_ASSIGN(const CheckedLight checked, check_light(renderer, settings, progress, cancelled, stages));
  const auto store = std::make_shared<light::LightStore>(*baked->store);
  store->check = checked.check;
  baked->store = store;
  baked->check_cpu_seconds = checked.cpu_seconds;
  return renderer.set_light(store, "the light just computed");
}

}  // namespace

Result<BakedLight> bake_light(render::Renderer& renderer, const BakeSettings& settings, int threads,
                              const std::function<void(double)>& progress, const std::function<bool()>& cancelled,
                              LightPieces* pieces) {
  const double baking_share = settings.check_eyes > 0 ? kBakingShare : 1.0;
  ComputedPieces computed;
  // With a limit of time the results depend on this host, so they are not mixed with others.
  const bool may_divide = pieces != nullptr && settings.max_cpu_seconds == 0.0;
  StageChain stages(may_divide ? *pieces : computed);
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  const std::size_t groups = 1 + renderer.scene().info.lamp_groups.size();
  Result<BakedLight> baked = Error(ErrorCode::kUnavailable, "there is nothing to compute");
  for (std::size_t group = 0; group < groups; ++group) {
    TRY(renderer.set_light(nullptr, ""));
    const auto share_of_progress = [&](double fraction) {
      if (progress) progress(baking_share * (static_cast<double>(group) + fraction) / static_cast<double>(groups));
    };
    Result<BakedLight> of_group =
        arena.execute([&] { return bake_group(renderer, settings, group, share_of_progress, cancelled, stages); });
    if (!of_group || group == 0) {
      baked = std::move(of_group);
    } else {
      add_group(*of_group, &*baked);
    }
    if (!baked) break;
  }
  if (baked && groups > 1) TRY(renderer.set_light(baked->store, "the light just computed"));
  if (baked && settings.check_eyes > 0) {
    const Status checked = add_check(
        renderer, settings.check_eyes,
        [&](double fraction) {
          if (progress) progress(baking_share + (1.0 - baking_share) * fraction);
        },
        cancelled, stages, &*baked);
    if (!checked) baked = checked.error();
  }
  if (!baked) TRY(renderer.set_light(nullptr, ""));
  return baked;
}

}  // namespace cyclorama::light_baking
