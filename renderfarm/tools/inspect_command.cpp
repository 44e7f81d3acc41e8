// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/inspect_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numbers>

#include "common/base/text.h"
#include "renderfarm/render/memory.h"
#include "renderfarm/render/requirements.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string text_of(const Eigen::Vector3d& v) { return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x(), v.y(), v.z()); }
std::string text_of(const Eigen::Vector3f& v) { return fmt::format("({:.3g}, {:.3g}, {:.3g})", v.x(), v.y(), v.z()); }

const char* name_of(LightKind kind) {
  switch (kind) {
    case LightKind::kPoint:
      return "point";
    case LightKind::kSpot:
      return "spot";
    case LightKind::kDirectional:
      return "directional";
    case LightKind::kRectangle:
      return "rectangle";
    case LightKind::kDisk:
      return "disk";
  }
  return "";
}

void print_light(const Scene& scene) {
  for (const Light& light : scene.model.lights) {
    const std::string size = light.kind == LightKind::kRectangle
                                 ? fmt::format("size {:.3f} x {:.3f}", light.size_m.x(), light.size_m.y())
                                 : fmt::format("radius {:.3f}", light.radius_m);
    fmt::print("  {} light '{}' at {}, intensity {}, {}\n", name_of(light.kind), printable(light.name),
               text_of(light.position), text_of(light.intensity), size);
  }
  fmt::print("sky         zenith {}, horizon {}, ground {}\n", text_of(scene.sky.zenith), text_of(scene.sky.horizon),
             text_of(scene.sky.ground));
  fmt::print("ambient     {}\neye lamp    {} cd\nexposure    {:.3f}\n", text_of(scene.ambient), text_of(scene.eye_lamp),
             scene.exposure);
}

Status inspect(const SceneOptions& options) {
  TRY_ASSIGN(const LoadedScene loaded, load_with_progress(options));
  const Scene& scene = loaded.scene;
  const Model& model = scene.model;
  std::size_t texels = 0;
  for (const Texture& texture : model.textures) texels += texture.pixels.data().size() / 4;
  fmt::print("title       {}\ncredits     {}\n", printable(scene.info.title, 200), printable(scene.info.credits, 400));
  fmt::print("triangles   {} stored, {} seen\n", scene.triangles_stored(), scene.triangles_seen());
  fmt::print("parts       {} meshes, {} instances, {} materials, {} textures ({:.1f} million texels)\n",
             model.meshes.size(), model.instances.size(), model.materials.size(), model.textures.size(),
             static_cast<double>(texels) / 1e6);
  fmt::print("memory      {} without the BVH\n", describe_bytes(scene.memory_bytes()));
  fmt::print("bounds      {} to {} m\n", text_of(Eigen::Vector3d(scene.bounds.min())),
             text_of(Eigen::Vector3d(scene.bounds.max())));
  fmt::print("start       {}, heading {:.1f} degrees, eye height {:.2f} m, {} corners to walk in, {} tour stops\n",
             text_of(scene.info.start_eye), scene.info.start_heading_rad / kDegree, scene.info.eye_height_m,
             scene.info.walkable.size(), scene.info.stops.size());
  fmt::print("lights      {}\n", model.lights.size());
  print_light(scene);
  fmt::print("kernel      compiled for: {}\n", describe(needs_of(scene)));
  for (const std::string& note : model.notes) fmt::print("note        {}\n", printable(note, 400));
  return Done{};
}

}  // namespace

RenderCommand add_inspect_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand("inspect", "Print what a scene holds and which kernel it gets");
  const auto options = std::make_shared<SceneOptions>();
  add_scene_options(parser, options.get());
  return {parser, [options](const StopSignal&) { return inspect(*options); }};
}

}  // namespace cyclorama
