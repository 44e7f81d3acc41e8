// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/view_options.h"

#include <fmt/format.h>

#include <numbers>
#include <utility>

#include "common/base/text.h"

namespace cyclorama::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Result<std::pair<int, int>> parse_size(const std::string& size) {
  const std::size_t cross = size.find('x');
  const auto width = parse_integer(std::string_view(size).substr(0, cross));
  const auto height =
      cross == std::string::npos ? std::nullopt : parse_integer(std::string_view(size).substr(cross + 1));
  constexpr long long kMaxSidePx = 16384;
  if (width && height && *width > 0 && *height > 0 && *width <= kMaxSidePx && *height <= kMaxSidePx) {
    return std::pair(static_cast<int>(*width), static_cast<int>(*height));
  }
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("--size '{}' is not WIDTHxHEIGHT, each 1 to {}", printable(size), kMaxSidePx));
}

}  // namespace

void add_view_options(CLI::App* command, ViewOptions* options) {
  command->add_option("--size", options->size, "WIDTHxHEIGHT in pixels for each eye")->capture_default_str();
  add_camera_options(command, &options->camera);
  command->add_option("--eye", options->eye, "x,y,z in metres; default: the scene's start")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--heading-deg", options->heading_deg, "Positive to the right; default: the scene's start");
  command->add_option("--seed", options->seed, "Seed of the noise")->capture_default_str();
}

Result<render::PanoramaView> view_of(const ViewOptions& options, const scene::SceneInfo& info) {
  TRY_ASSIGN(const auto size, parse_size(options.size));
  render::PanoramaView view;
  view.eye = options.eye.empty() ? info.start_eye : Eigen::Vector3d(options.eye[0], options.eye[1], options.eye[2]);
  view.heading_rad = options.heading_deg ? *options.heading_deg * kDegree : info.start_heading_rad;
  TRY_ASSIGN(view.projection, projection_of(options.camera, size.first, size.second));
  view.seed = options.seed;
  TRY(render::check_view(view, {}));
  return view;
}

Result<render::PanoramaView> panorama_view_of(const ViewOptions& options, const scene::SceneInfo& info) {
  TRY_ASSIGN(const render::PanoramaView view, view_of(options, info));
  const Projection projection = view.picture();
  const auto* const panorama = std::get_if<Panorama>(&projection.shape);
  if (panorama == nullptr || projection.viewing.eyes != Eyes::kMono) {
    return Error(ErrorCode::kInvalidArgument,
                 "this command makes panoramas for one eye: leave out --camera and --stereo");
  }
  render::PanoramaView result;
  result.eye = view.eye;
  result.heading_rad = view.heading_rad;
  result.panorama = *panorama;
  result.seed = view.seed;
  return result;
}

}  // namespace cyclorama::tools
