// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/render_command.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/clock.h"
#include "common/base/file.h"
#include "common/process/progress.h"
#include "renderfarm/render/memory.h"

namespace cyclorama::tools {

void add_scene_options(CLI::App* command, SceneOptions* options) {
  command
      ->add_option("scene", options->scene, "A scene package, or one .glb, .gltf, .ply, .obj, .las, .e57 or .spz file")
      ->required();
  command->add_option("--threads", options->threads, "Threads; 0 means all")->check(CLI::Range(0, 1024));
  command
      ->add_option(
          "--memory", options->memory,
          "Memory of each triangle: fast (most), medium, or compact (least, and slowest); by itself the fastest "
          "that fits")
      ->check(CLI::IsMember({"fast", "medium", "compact"}));
}

Result<LoadedScene> load_with_progress(const SceneOptions& options) {
  const SteadyClock clock;
  const TimePoint start = clock.now();
  Progress progress("loading");
  scene::ImportLimits limits;
  limits.memory_bytes = render::available_memory().value_or(limits.memory_bytes);
  TRY_ASSIGN(scene::Scene scene,
             scene::load_scene(options.scene, limits, [&](double fraction) { progress.update(fraction); }));
  return LoadedScene{std::move(scene), to_seconds(clock.now() - start)};
}

Result<std::unique_ptr<render::Renderer>> build_with_progress(scene::Scene scene, const SceneOptions& options) {
  Progress progress("building the BVH");
  std::optional<render::MemoryMode> mode;
  for (const render::MemoryMode named : render::kMemoryModes) {
    if (options.memory == render::name_of(named)) mode = named;
  }
  return render::Renderer::build(
      std::move(scene), options.threads, [&](double fraction) { progress.update(fraction); }, mode);
}

Error stopped() { return Error(ErrorCode::kUnavailable, "stopped before it was finished"); }

Status write_json(const std::string& path, const nlohmann::json& values) {
  return write_file_atomically(path, std::string_view(values.dump(2) + "\n"));
}

}  // namespace cyclorama::tools
