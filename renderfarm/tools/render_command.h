// SPDX-License-Identifier: Apache-2.0
/// What the sub-commands of cyclorama-render have in common: how one is added, and how it comes by its scene.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// One sub-command. Each has a function `RenderCommand add_x_command(CLI::App* program)` in x_command.h;
/// render_main.cpp runs the one that was parsed.
struct RenderCommand {
  CLI::App* parser = nullptr;  ///< The program's.
  std::function<Status(const StopSignal&)> run;
};

/// Which scene, and with how many threads.
struct SceneOptions {
  std::string scene;
  int threads = 0;
};

void add_scene_options(CLI::App* command, SceneOptions* options);

struct LoadedScene {
  Scene scene;
  double seconds = 0.0;
};

/// load_scene() within the memory that is there, and Renderer::build(), with a progress bar.
Result<LoadedScene> load_with_progress(const SceneOptions& options);
Result<std::unique_ptr<Renderer>> build_with_progress(Scene scene, const SceneOptions& options);

/// What a command returns when StopSignal ended it.
[[nodiscard]] Error stopped();

/// Indented; the file is replaced at once or not at all.
Status write_json(const std::string& path, const nlohmann::json& values);

}  // namespace cyclorama
