// SPDX-License-Identifier: Apache-2.0
// The tracker's figures: tracker_bench pose|real|speed|trade|extremes [--quick] [--threads N] [--json FILE].
#include "tests/bench/tracker/tracker_bench.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>

int main(int argc, char** argv) {
  CLI::App app("Measures the tracker.");
  std::string what, json;
  bool quick = false;
  int threads = 2;
  int frames = 100'000;
  double seconds = 1e9;
  std::string keep, only;
  int scenes = 0;
  app.add_option("WHAT", what)->required()->check(CLI::IsMember({"pose", "real", "speed", "trade", "extremes"}));
  app.add_flag("--quick", quick);
  app.add_option("--threads", threads)->check(CLI::Range(1, 64));
  app.add_option("--frames", frames)->check(CLI::Range(100, 10'000'000));
  app.add_option("--keep", keep, "pose: what was measured; go on from there");
  app.add_option("--seconds", seconds, "pose: stop after so long");
  app.add_option("--only", only, "trade: one knob")->check(CLI::IsMember({"filter", "decimation", "size", "fold"}));
  app.add_option("--scenes", scenes, "trade: of ten pictures, for each value")->check(CLI::Range(1, 100'000));
  app.add_option("--json", json);
  CLI11_PARSE(app, argc, argv);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // Line-buffered, so that results appear at once, in a log too.
  nlohmann::json figures;
  if (what == "pose") figures = cyclorama::measure_pose(quick ? 2000 : frames, threads, keep, seconds);
  if (what == "real") figures = cyclorama::measure_real();
  if (what == "speed") figures = cyclorama::measure_speed(quick ? 120 : 840);
  if (what == "trade") figures = cyclorama::measure_trade(quick, only, scenes);
  if (what == "extremes") figures = cyclorama::measure_extremes(quick);
  if (json.empty()) {
    std::printf("%s\n", figures.dump().c_str());
  } else {
    std::ofstream(json) << figures;
  }
  return 0;
}
