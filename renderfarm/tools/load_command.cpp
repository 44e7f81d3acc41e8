// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/load_command.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "renderfarm/render/memory.h"

namespace cyclorama::tools {
namespace {

struct LoadOptions {
  SceneOptions scene;
  std::string json;
};

std::size_t peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

/// Returns the bytes of this process that are in memory; 0 if they are not known.
std::size_t resident_memory() {
  std::ifstream file("/proc/self/statm");
  std::size_t reserved = 0;
  std::size_t resident = 0;
  if (!(file >> reserved >> resident)) return 0;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

Status measure_load(const LoadOptions& options, const StopSignal& stop) {
  const std::size_t resident_before = resident_memory();
  TRY_ASSIGN(LoadedScene loaded, load_with_progress(options.scene));
  if (stop.requested()) return stopped();
  const double load_seconds = loaded.seconds;
  const std::uint64_t stored = loaded.scene.triangles_stored();
  const std::uint64_t seen = loaded.scene.triangles_seen();
  const std::size_t scene_bytes = loaded.scene.memory_bytes();
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             build_with_progress(std::move(loaded.scene), options.scene));
  const auto per_triangle = [&](std::size_t bytes) { return static_cast<double>(bytes) / static_cast<double>(stored); };
  const std::size_t resident_bytes = resident_memory() - std::min(resident_memory(), resident_before);
  const double bvh_seconds = renderer->build_seconds();
  const std::size_t bvh_bytes = renderer->bvh_bytes();
  const std::size_t shading_bytes = renderer->shading_bytes();
  fmt::print("{} triangles stored, {} seen; loaded in {:.2f} s, BVH in {:.2f} s\n", stored, seen, load_seconds,
             bvh_seconds);
  fmt::print(
      "{:.1f} bytes per triangle, {:.1f} more for shading and {:.1f} reserved for the BVH ({}); {:.1f} of all are "
      "in memory; {} at most\n",
      per_triangle(scene_bytes), per_triangle(shading_bytes), per_triangle(bvh_bytes),
      render::name_of(renderer->memory_mode()), per_triangle(resident_bytes), render::describe_bytes(peak_memory()));
  if (options.json.empty()) return Done{};
  return write_json(options.json, {{"memory", render::name_of(renderer->memory_mode())},
                                   {"triangles", stored},
                                   {"triangles_seen", seen},
                                   {"load_s", load_seconds},
                                   {"bvh_s", bvh_seconds},
                                   {"seconds", load_seconds + bvh_seconds},
                                   {"scene_bytes", scene_bytes},
                                   {"shading_bytes", shading_bytes},
                                   {"bvh_bytes", bvh_bytes},
                                   {"scene_bytes_per_triangle", per_triangle(scene_bytes)},
                                   {"bvh_bytes_per_triangle", per_triangle(bvh_bytes)},
                                   {"bytes_per_triangle", per_triangle(scene_bytes + shading_bytes + bvh_bytes)},
                                   {"resident_bytes_per_triangle", per_triangle(resident_bytes)},
                                   {"peak_rss_bytes", peak_memory()}});
}

}  // namespace

RenderCommand add_load_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand("load", "Measure the time and memory of loading");
  const auto options = std::make_shared<LoadOptions>();
  add_scene_options(parser, &options->scene);
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return measure_load(*options, stop); }};
}

}  // namespace cyclorama::tools
