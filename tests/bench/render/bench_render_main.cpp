// SPDX-License-Identifier: Apache-2.0
/// cyclorama-bench-render: measures the renderer, its pictures and their codecs, without a farm.
#include <array>

#include "common/process/program.h"
#include "tests/bench/render/denoise_command.h"
#include "tests/bench/render/depth_command.h"
#include "tests/bench/render/extremes_command.h"
#include "tests/bench/render/features_command.h"
#include "tests/bench/render/governed_command.h"
#include "tests/bench/render/jpeg_command.h"
#include "tests/bench/render/light_bake_command.h"
#include "tests/bench/render/light_command.h"
#include "tests/bench/render/light_leaks_command.h"
#include "tests/bench/render/trade_command.h"
#include "tests/bench/render/visit_command.h"
#include "tests/bench/render/vitrine_command.h"
#include "tests/bench/render/watermark_curve_command.h"

int main(int argc, char** argv) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  Program program("cyclorama-bench-render", "Measures the renderer, its pictures and their codecs, without a farm.");
  CLI::App* const options = &program.options();
  options->require_subcommand(1);
  const std::array commands{
      add_denoise_command(options),        add_depth_command(options),    add_extremes_command(options),
      add_features_command(options),       add_governed_command(options), add_jpeg_command(options),
      add_light_bake_command(options),     add_light_command(options),    add_light_leaks_command(options),
      add_trade_command(options),          add_visit_command(options),    add_vitrine_command(options),
      add_watermark_curve_command(options)};
  return program.run(argc, argv, [&](const StopSignal& stop) -> Status {
    for (const tools::RenderCommand& command : commands) {
      if (command.parser->parsed()) return command.run(stop);
    }
    return Done{};
  });
}
