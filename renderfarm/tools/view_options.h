// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"
#include "renderfarm/tools/camera_options.h"

namespace cyclorama {

/// Where a command's picture is taken from, with which camera, and its size.
struct ViewOptions {
  std::string size = "2048x768";
  CameraOptions camera;
  std::vector<double> eye;
  std::optional<double> heading_deg;
  std::uint64_t seed = 0;
};

void add_view_options(CLI::App* command, ViewOptions* options);

/// What is left out is the scene's start. The quality is the default one. kInvalidArgument  names the option.
Result<PanoramaView> view_of(const ViewOptions& options, const SceneInfo& info);

/// The same for commands that know panoramas alone: the others are refused.
Result<PanoramaView> panorama_view_of(const ViewOptions& options, const SceneInfo& info);

}  // namespace cyclorama
