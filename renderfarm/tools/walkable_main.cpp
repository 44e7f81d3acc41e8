// SPDX-License-Identifier: Apache-2.0
/// cyclorama-walkable: finds the walkable area of a scene. Runs where the geometry is; only the ground's outline leaves
/// that machine.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/file.h"
#include "common/image/png.h"
#include "common/process/program.h"
#include "common/process/progress.h"
#include "renderfarm/scene/area.h"
#include "renderfarm/scene/scene_package.h"
#include "renderfarm/walkable/walkable_file.h"
#include "renderfarm/walkable/walkable_picture.h"

namespace cyclorama::tools {
namespace {

struct Options {
  std::filesystem::path scene;
  bool save = false;
  std::filesystem::path picture;
  std::filesystem::path json;
  walkable::GroundOptions ground;
};

void add_options(CLI::App& app, Options* options) {
  app.add_option("scene", options->scene, "A scene package (a folder with scene.toml), or one geometry file")
      ->required();
  app.add_flag("--save", options->save, "Write the area into the package's scene.toml, replacing the existing one");
  app.add_option("--picture", options->picture, "Draw the result from above, as PNG")->type_name("FILE");
  app.add_option("--json", options->json, "Write the figures as JSON")->type_name("FILE");
  app.add_option("--cell-m", options->ground.cell_m, "Size of the cells, for an eye at 1.6 m")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  app.add_option("--reach-m", options->ground.reach_m, "Maximum distance from the start, for an eye at 1.6 m")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
}

bool holds(const walkable::WalkableGround& ground, const Eigen::Vector3d& eye) {
  const Eigen::Vector2d place(eye.x(), eye.z());
  for (const auto& hole : ground.holes) {
    if (scene::is_inside(hole, place)) return false;
  }
  return scene::is_inside(ground.outline, place);
}

Status save(const std::filesystem::path& scene, const walkable::WalkableGround& ground, const scene::SceneInfo& info) {
  constexpr std::size_t kLimitBytes = std::size_t{1} << 20;
  const std::filesystem::path file = std::filesystem::is_directory(scene) ? scene / "scene.toml" : scene;
  if (file.extension() != ".toml") {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is no scene package, so there is no scene.toml to save to; make a folder with one "
                             "that names it, and paste the lines above",
                             scene.string()));
  }
  TRY_ASSIGN(const std::string text, read_text_file(file, kLimitBytes));
  TRY_ASSIGN(const std::string changed, walkable::with_walkable(text, file.string(), ground, info.start_eye));
  // The written text must parse as a scene package.
  TRY(scene::parse_scene_package(changed, file.string(), file.parent_path()));
  TRY(write_file_atomically(file, changed));
  fmt::print("saved to '{}'\n", file.string());
  return Done{};
}

Status write_json(const Options& options, const walkable::WalkableGround& ground, double seconds, int stops_outside) {
  std::size_t corners = ground.outline.size();
  for (const auto& hole : ground.holes) corners += hole.size();
  const nlohmann::json figures = {
      {"area_m2", ground.area_m2},   {"corners", corners}, {"holes", ground.holes.size()},  {"cell_m", ground.cell_m},
      {"radius_m", ground.radius_m}, {"seconds", seconds}, {"stops_outside", stops_outside}};
  return write_file_atomically(options.json, figures.dump(2) + "\n");
}

Status run(const Options& options) {
  Progress progress("loading");
  TRY_ASSIGN(const scene::Scene scene,
             scene::load_scene(options.scene, scene::ImportLimits{}, [&](double done) { progress.update(done); }));
  const TimePoint began = SteadyClock().now();
  TRY_ASSIGN(const walkable::RayProbe probe, walkable::RayProbe::build(scene, scene.info.start_eye));
  TRY_ASSIGN(const walkable::WalkableGround ground,
             walkable::find_walkable(probe, scene.info, scene.bounds, options.ground));
  const double seconds = to_seconds(SteadyClock().now() - began);
  if (!options.save) fmt::print("[visitor]\n{}\n{}", walkable::walkable_key(ground), walkable::hole_tables(ground));
  fmt::print("{:.1f} m2 to walk on, around {} holes, {:.2f} m from everything, found in {:.1f} s\n", ground.area_m2,
             ground.holes.size(), ground.radius_m, seconds);
  int stops_outside = 0;
  for (const scene::SceneTourStop& stop : scene.info.stops) {
    if (holds(ground, stop.eye)) continue;
    ++stops_outside;
    fmt::print("the stop '{}' is outside the area: the tour goes to the nearest point inside\n", stop.title);
  }
  if (!options.picture.empty()) TRY(write_png(options.picture, walkable::walkable_picture(ground, scene.info)));
  if (!options.json.empty()) TRY(write_json(options, ground, seconds, stops_outside));
  if (options.save) TRY(save(options.scene, ground, scene.info));
  return Done{};
}

}  // namespace
}  // namespace cyclorama::tools

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-walkable",
                             "Finds where visitors can walk in a scene, from its geometry: ground, headroom, steps, "
                             "slopes, and what is in the way.");
  cyclorama::tools::Options options;
  cyclorama::tools::add_options(program.options(), &options);
  return program.run(argc, argv, [&](const cyclorama::StopSignal&) { return cyclorama::tools::run(options); });
}
