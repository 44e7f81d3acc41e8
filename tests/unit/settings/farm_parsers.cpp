// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "common/base/file.h"
#include "renderfarm/coordinator/coordinator_config.h"
#include "renderfarm/governor/pareto_front_file.h"
#include "renderfarm/node/node_config.h"
#include "renderfarm/scene/scene_package.h"
#include "renderfarm/trust/grants.h"
#include "tests/unit/settings/settings_parsers.h"

namespace cyclorama {
namespace {

namespace fs = std::filesystem;

/// A scene package with the files that examples name; a missing one would be a mistake in scene.toml.
struct ExamplePackage {
  ExamplePackage() {
    fs::create_directories(folder);
    for (const char* const name : {"walls.ply", "figures.glb", "garden.hdr"}) {
      static_cast<void>(write_file_atomically(folder / name, std::string_view("x")));
    }
  }
  ~ExamplePackage() { fs::remove_all(folder); }

  fs::path folder = fs::temp_directory_path() / fmt::format("settings_examples_{}", getpid());
};

}  // namespace

std::map<std::string, Parser> farm_parsers() {
  static const ExamplePackage package;
  return {
      {"farm.toml", parser(coordinator::parse_coordinator_config)},
      {"pareto_front.toml", parser(governor::parse_pareto_front)},
      {"museums.toml", parser(trust::Grants::parse)},
      {"node.toml", parser(node::parse_node_config)},
      {"scene.toml", parser([](const auto& text, const auto& name) {
         return scene::parse_scene_package(text, name, package.folder);
       })},
  };
}

}  // namespace cyclorama
