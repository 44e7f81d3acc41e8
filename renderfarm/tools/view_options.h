// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"
#include "renderfarm/tools/camera_options.h"

namespace cyclorama::tools {

/// Eye, camera and size of a command's picture.
struct ViewOptions {
  std::string size = "2048x768";
  CameraOptions camera;
  std::vector<double> eye;
  std::optional<double> heading_deg;
  std::uint64_t seed = 0;
};

void add_view_options(CLI::App* command, ViewOptions* options);

/// Returns the view that the options describe. Absent values are those of the scene's start; the quality is the
/// default. Errors: kInvalidArgument, which names the option.
Result<render::PanoramaView> view_of(const ViewOptions& options, const scene::SceneInfo& info);

/// Returns the view like view_of(), for commands that support only panoramas; other cameras are refused.
Result<render::PanoramaView> panorama_view_of(const ViewOptions& options, const scene::SceneInfo& info);

}  // namespace cyclorama::tools
