// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/inspect_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <numbers>
#include <utility>

#include "common/base/text.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/render/lights/light_set.h"
#include "renderfarm/render/memory.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/tools/defect_report.h"
#include "renderfarm/tools/scene_need.h"

namespace cyclorama::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string text_of(const Eigen::Vector3d& v) { return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x(), v.y(), v.z()); }
std::string text_of(const Eigen::Vector3f& v) { return fmt::format("({:.3g}, {:.3g}, {:.3g})", v.x(), v.y(), v.z()); }

const char* name_of(scene::LightKind kind) {
  switch (kind) {
    case scene::LightKind::kPoint:
      return "point";
    case scene::LightKind::kSpot:
      return "spot";
    case scene::LightKind::kDirectional:
      return "directional";
    case scene::LightKind::kRectangle:
      return "rectangle";
    case scene::LightKind::kDisk:
      return "disk";
  }
  return "";
}

void print_light(const scene::Scene& scene) {
  for (const scene::Light& light : scene.model.lights) {
    const std::string size = light.kind == scene::LightKind::kRectangle
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

const char* name_of(scene::ToneCurve curve) {
  switch (curve) {
    case scene::ToneCurve::kShoulder:
      return "shoulder";
    case scene::ToneCurve::kLinear:
      return "linear";
    case scene::ToneCurve::kFilmic:
      return "filmic";
  }
  return "";
}

void print_needs(const scene::Scene& scene) {
  const std::vector<NamedNeed> needs = named_needs(scene);
  const char* heading = "needs";
  for (const NamedNeed& need : needs) {
    if (!need.what.empty()) fmt::print("{:<12}{:<18}{}\n", std::exchange(heading, ""), need.name, need.what);
  }
  std::vector<std::string> left_out;
  for (const NamedNeed& need : needs) {
    if (need.what.empty()) left_out.push_back(need.name);
  }
  fmt::print("left out    {}\n", left_out.empty() ? "nothing" : fmt::format("{}", fmt::join(left_out, ", ")));
}

/// Prints the facts that are available once the scene is ready to be traced.
void print_traced(const render::Renderer& renderer) {
  const render::LightSet& lights = renderer.lights();
  fmt::print("aimed at    {} lamps, {} flat lights, {} glowing triangles, {} suns{}; chosen by {}\n",
             lights.lamps().size(), lights.flats().size(), lights.triangles(), lights.suns().size(),
             lights.has_environment() ? ", the environment" : "", lights.chooses_by_tree() ? "a tree" : "a list");
  fmt::print("memory      {} with the BVH ({}) and what shading reads ({}), {}\n",
             render::describe_bytes(renderer.scene().memory_bytes() + renderer.bvh_bytes() + renderer.shading_bytes()),
             render::describe_bytes(renderer.bvh_bytes()), render::describe_bytes(renderer.shading_bytes()),
             render::name_of(renderer.memory_mode()));
}

/// Prints the properties of the scene's stored light, or why it cannot be used.
void print_stored_light(const std::filesystem::path& scene, const render::Renderer& renderer) {
  const std::filesystem::path file = scene / light::kLightFileName;
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) {
    fmt::print("computed    no light; 'cyclorama-render light' computes it, and nodes do while they are idle\n");
    return;
  }
  const Result<light::LightStore> store = light::read_light_file(file);
  const Status fits = store ? renderer.check_light(*store, file.string()) : Status(store.error());
  if (!fits) {
    fmt::print("computed    {}\n", printable(fits.error().message(), 400));
    return;
  }
  fmt::print("computed    light: {}, {} samples, {:.1f} bytes per triangle\n            {}\n            {}\n",
             render::describe_bytes(store->bytes()), store->sample_count(),
             static_cast<double>(store->bytes()) / static_cast<double>(renderer.scene().triangles_seen()),
             printable(store->settings, 400), light::description_of(*store));
}

struct InspectOptions {
  SceneOptions scene;
  std::string pictures;
  bool repair = false;
};

Status inspect(const InspectOptions& chosen) {
  const SceneOptions& options = chosen.scene;
  if (chosen.repair) TRY(save_repair(options.scene));
  TRY_ASSIGN(LoadedScene loaded, load_with_progress(options));
  const scene::Scene& scene = loaded.scene;
  const scene::Model& model = scene.model;
  std::size_t texels = 0;
  for (const scene::Texture& texture : model.textures) texels += texture.pixels.data().size() / 4;
  fmt::print("title       {}\ncredits     {}\n", printable(scene.info.title, 200), printable(scene.info.credits, 400));
  fmt::print("triangles   {} stored, {} seen\n", scene.triangles_stored(), scene.triangles_seen());
  fmt::print("parts       {} meshes, {} instances, {} materials, {} textures ({:.1f} million texels)\n",
             model.meshes.size(), model.instances.size(), model.materials.size(), model.textures.size(),
             static_cast<double>(texels) / 1e6);
  for (const scene::SplatCloud& cloud : model.splats) {
    fmt::print("splats      {} of degree {}, blended as {}\n", cloud.size(), cloud.degree,
               cloud.is_linear ? "linear light" : "sRGB codes");
  }
  fmt::print("memory      {} without the BVH\n", render::describe_bytes(scene.memory_bytes()));
  fmt::print("bounds      {} to {} m\n", text_of(Eigen::Vector3d(scene.bounds.min())),
             text_of(Eigen::Vector3d(scene.bounds.max())));
  fmt::print("start       {}, heading {:.1f} degrees, eye height {:.2f} m, {} corners to walk in, {} tour stops\n",
             text_of(scene.info.start_eye), scene.info.start_heading_rad / kDegree, scene.info.eye_height_m,
             scene.info.walkable.size(), scene.info.stops.size());
  fmt::print("lights      {}\n", model.lights.size());
  if (!scene.info.lamp_groups.empty()) fmt::print("groups      {}\n", fmt::join(scene.info.lamp_groups, ", "));
  print_light(scene);
  fmt::print("tone        {}\n", name_of(scene.tone));
  print_needs(scene);
  fmt::print("kernel      for {}\n", render::describe(render::highest_surface_level(scene)));
  for (const std::string& note : model.notes) fmt::print("note        {}\n", printable(note, 400));
  const scene::Defects defects = scene::find_defects(model);
  print_defects(defects);
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer, build_with_progress(std::move(loaded.scene), options));
  if (!chosen.pictures.empty()) TRY(draw_defects(*renderer, defects, chosen.pictures));
  print_traced(*renderer);
  print_stored_light(options.scene, *renderer);
  return Done{};
}

}  // namespace

RenderCommand add_inspect_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand("inspect", "Print the content of a scene and its kernel");
  const auto options = std::make_shared<InspectOptions>();
  add_scene_options(parser, &options->scene);
  parser->add_option("--pictures", options->pictures, "Draw the largest defects of each kind into this folder");
  parser->add_flag(
      "--repair", options->repair,
      "First write repair = true into scene.toml, with which the scene is loaded without what is broken, as "
      "far as that is safe");
  return {parser, [options](const StopSignal&) { return inspect(*options); }};
}

}  // namespace cyclorama::tools
