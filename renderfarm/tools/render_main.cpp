// SPDX-License-Identifier: Apache-2.0
/// cyclorama-render: pictures and facts of a scene, without a farm.
#include <array>

#include "common/process/program.h"
#include "renderfarm/tools/compare_command.h"
#include "renderfarm/tools/inspect_command.h"
#include "renderfarm/tools/light_command.h"
#include "renderfarm/tools/load_command.h"
#include "renderfarm/tools/picture_command.h"
#include "renderfarm/tools/watermark_command.h"

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::tools;  // NOLINT(google-build-using-namespace)
  Program program("cyclorama-render", "Renders pictures of a scene and prints its properties, without a farm.");
  CLI::App* const options = &program.options();
  options->require_subcommand(1);
  const std::array commands{add_picture_command(options), add_inspect_command(options), add_light_command(options),
                            add_load_command(options),    add_compare_command(options), add_watermark_command(options)};
  return program.run(argc, argv, [&](const StopSignal& stop) -> Status {
    for (const RenderCommand& command : commands) {
      if (command.parser->parsed()) return command.run(stop);
    }
    return Done{};
  });
}
