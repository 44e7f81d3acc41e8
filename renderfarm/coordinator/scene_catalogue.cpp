// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/scene_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "common/base/check.h"
#include "common/base/text.h"
#include "common/wire/convert.h"
#include "renderfarm/governor/pareto_front_file.h"
#include "renderfarm/governor/stored_light_front.h"

namespace cyclorama::coordinator {

SceneCatalogue::SceneCatalogue(std::vector<FarmScene> scenes) : scenes_(std::move(scenes)) { CHECK(!scenes_.empty()); }

const FarmScene& SceneCatalogue::at(const std::string& name) const {
  const auto found = std::ranges::find(scenes_, name, &FarmScene::name);
  CHECK(found != scenes_.end());
  return *found;
}

Result<FarmScene> SceneCatalogue::find(const std::string& wanted, const trust::Grant& grant,
                                       const std::string& museum) const {
  const auto found = std::ranges::find_if(scenes_, [&](const FarmScene& known) {
    return (wanted.empty() || known.name == wanted) && grant.allows(known.name);
  });
  if (found != scenes_.end()) return *found;
  if (wanted.empty()) return Error(ErrorCode::kNotFound, fmt::format("this farm has no scene for '{}'", museum));
  return Error(ErrorCode::kNotFound,
               fmt::format("this farm has no scene '{}'; request the list of scenes", printable(wanted)));
}

wire::ListScenesReply SceneCatalogue::list(const trust::Grant& grant) const {
  wire::ListScenesReply reply;
  for (const FarmScene& scene : scenes_) {
    if (!grant.allows(scene.name)) continue;
    wire::SceneSummary* const summary = reply.add_scenes();
    summary->set_name(scene.name);
    const wire::SceneDescription* const known = description(scene.name);
    summary->set_title(known != nullptr && !known->title().empty() ? known->title() : scene.name);
  }
  return reply;
}

const FarmScene& SceneCatalogue::set_digest(const std::string& scene, const std::string& digest) {
  const auto known = std::ranges::find(scenes_, scene, &FarmScene::name);
  CHECK(known != scenes_.end() && known->on_coordinator && known->digest.empty());
  known->digest = digest;
  return *known;
}

const wire::SceneDescription* SceneCatalogue::description(const std::string& scene) const {
  const auto known = descriptions_.find(scene);
  return known == descriptions_.end() ? nullptr : &known->second;
}

Status SceneCatalogue::learn(const wire::SceneLoaded& loaded) {
  TRY(validate(loaded.description()));
  descriptions_[loaded.scene()] = loaded.description();
  pareto_fronts_.erase(loaded.scene());
  bounces_.erase(loaded.scene());
  if (loaded.has_bounces()) {
    TRY(render::check_knob("bounces", loaded.bounces(), 0, render::kMaxBounces));
    bounces_.emplace(loaded.scene(), static_cast<int>(loaded.bounces()));
  }
  if (loaded.front().empty()) return Done{};
  TRY_ASSIGN(const governor::ParetoFront front,
             governor::parse_pareto_front(loaded.front(), governor::kParetoFrontFileName));
  pareto_fronts_.emplace(loaded.scene(), front);
  return Done{};
}

std::unique_ptr<GovernorState> SceneCatalogue::governed(double budget_ms, int reference_samples,
                                                        const std::string& scene, bool has_light) const {
  const auto measured = pareto_fronts_.find(scene);
  if (measured != pareto_fronts_.end() && (has_light || !governor::uses_stored_light(measured->second))) {
    return std::make_unique<GovernorState>(governor::Governor(measured->second, budget_ms), reference_samples,
                                           std::nullopt);
  }
  const auto known = bounces_.find(scene);
  const int bounces = known == bounces_.end() ? governor::kStandardBounces : known->second;
  governor::ParetoFront front =
      has_light ? governor::stored_light_front(bounces) : governor::ParetoFront::standard(bounces);
  return std::make_unique<GovernorState>(governor::Governor(std::move(front), budget_ms), reference_samples, bounces);
}

}  // namespace cyclorama::coordinator
