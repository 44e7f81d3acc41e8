// SPDX-License-Identifier: Apache-2.0
/// Common parts of cyclorama-render's sub-commands: registration and loading of the scene.
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

namespace cyclorama::tools {

/// One sub-command. Each has a function `RenderCommand add_x_command(CLI::App* program)` in x_command.h;
/// render_main.cpp runs the command that was parsed.
struct RenderCommand {
  CLI::App* parser = nullptr;  ///< Owned by the program.
  std::function<Status(const StopSignal&)> run;
};

/// Options that select the scene, the number of threads, and the memory of each triangle.
struct SceneOptions {
  std::string scene;
  int threads = 0;
  std::string memory;  ///< Name of a render::MemoryMode; empty selects the fastest one that fits.
};

void add_scene_options(CLI::App* command, SceneOptions* options);

struct LoadedScene {
  scene::Scene scene;
  double seconds = 0.0;
};

/// load_with_progress() calls load_scene() within the available memory, and build_with_progress() calls
/// Renderer::build(); both show a progress bar.
Result<LoadedScene> load_with_progress(const SceneOptions& options);
Result<std::unique_ptr<render::Renderer>> build_with_progress(scene::Scene scene, const SceneOptions& options);

/// Returns the error of a command that StopSignal ended.
[[nodiscard]] Error stopped();

/// Writes indented JSON; the file is replaced completely or not at all.
Status write_json(const std::string& path, const nlohmann::json& values);

}  // namespace cyclorama::tools
