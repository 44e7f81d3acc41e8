// SPDX-License-Identifier: Apache-2.0
// Times of simulated museums: to make one, per new pose of the camera, and per photograph of a new pattern. Also writes
// their pictures. Usage: museum_bench [--quick] [--pictures FOLDER].
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <numbers>

#include "common/base/clock.h"
#include "common/image/png.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/museum/simulated_museum.h"

namespace cyclorama {
namespace {

/// Stripes of one bit of a Gray code, as in calibrations.
RgbImage stripes(const Pinhole& lens, int bit, bool is_inverse) {
  RgbImage picture(lens.width_px, lens.height_px);
  for (int y = 0; y < lens.height_px; ++y) {
    for (int x = 0; x < lens.width_px; ++x) {
      const int position = bit % 2 == 0 ? x : y;
      const int gray = position ^ (position >> 1);
      const bool is_lit = ((gray >> (bit / 2)) & 1) != (is_inverse ? 1 : 0);
      std::fill_n(picture.at(x, y), 3, static_cast<std::uint8_t>(is_lit ? 255 : 0));
    }
  }
  return picture;
}

/// A grid in a projector's own colour on grey, with a thick frame.
RgbImage chart(const Pinhole& lens, std::size_t projector) {
  RgbImage picture(lens.width_px, lens.height_px, 40);
  for (int y = 0; y < lens.height_px; ++y) {
    for (int x = 0; x < lens.width_px; ++x) {
      const bool is_frame = std::min({x, y, lens.width_px - 1 - x, lens.height_px - 1 - y}) < 12;
      const bool is_line = x % 120 < 4 || y % 120 < 4;
      if (is_frame || is_line) picture.at(x, y)[projector % 3] = 255;
      if (is_frame) picture.at(x, y)[(projector + 1) % 3] = 160;
    }
  }
  return picture;
}

struct Times {
  double make_s = 0.0;
  double pose_ms = 0.0;
  double grey_ms = 0.0;
  double colour_ms = 0.0;
  double calibration_s = 0.0;  ///< For 12 directions with 60 patterns on all projectors at once.
};

Result<Times> measure(const simulated::Preset& preset, int directions, int patterns, bool is_whole) {
  const SteadyClock clock;
  Times times;
  TimePoint begun = clock.now();
  TRY_ASSIGN(simulated::SimulatedMuseum museum, simulated::SimulatedMuseum::make(preset.installation, preset.truth));
  times.make_s = to_seconds(clock.now() - begun);
  std::vector<RgbImage> pictures;
  for (int i = 0; i < patterns; ++i)
    pictures.push_back(stripes(preset.installation.projectors[0].lens, (i / 2) % 22, i % 2 == 1));
  double pose_s = 0.0;
  double photograph_s = 0.0;
  for (int d = 0; d < directions; ++d) {
    museum.turn_to((d - 0.5 * (directions - 1)) * std::numbers::pi / 18.0);
    // The first photograph computes the geometry; the next ones measure new patterns.
    begun = clock.now();
    TRY_ASSIGN(const simulated::GreyPhotograph first, museum.photograph_grey(1.0 / 30.0));
    pose_s += to_seconds(clock.now() - begun);
    begun = clock.now();
    for (const RgbImage& picture : pictures) {
      for (std::size_t i = 0; i < museum.projector_count(); ++i) TRY(museum.show(i, picture));
      museum.settle();
      TRY_ASSIGN(const simulated::GreyPhotograph seen, museum.photograph_grey(1.0 / 30.0));
    }
    photograph_s += to_seconds(clock.now() - begun);
  }
  begun = clock.now();
  for (std::size_t i = 0; i < museum.projector_count(); ++i) TRY(museum.show(i, pictures[0]));
  museum.settle();
  TRY_ASSIGN(const simulated::RgbPhotograph colour, museum.photograph_colour(1.0 / 30.0));
  times.colour_ms = 1e3 * to_seconds(clock.now() - begun);
  times.grey_ms = 1e3 * photograph_s / directions / patterns;
  times.pose_ms = 1e3 * pose_s / directions - times.grey_ms;
  times.calibration_s = is_whole ? times.make_s + pose_s + photograph_s
                                 : times.make_s + 12.0 * 1e-3 * (times.pose_ms + 60.0 * times.grey_ms);
  return times;
}

Status take_pictures(const std::string& name, const simulated::Preset& preset, const std::filesystem::path& folder) {
  TRY_ASSIGN(simulated::SimulatedMuseum museum, simulated::SimulatedMuseum::make(preset.installation, preset.truth));
  for (std::size_t i = 0; i < museum.projector_count(); ++i)
    TRY(museum.show(i, chart(preset.installation.projectors[i].lens, i)));
  museum.settle();
  TRY_ASSIGN(const simulated::RgbPhotograph seen, museum.photograph_colour(0.1));
  return write_png(folder / (name + ".png"), simulated::to_8_bits(seen, museum.camera_bits()));
}

Status run(bool is_quick, const std::string& pictures) {
  nlohmann::json report;
  if (pictures.empty())
    fmt::print("{:<20} {:>7} {:>9} {:>15} {:>10} {:>14}\n", "room", "make, s", "pose, ms", "photograph, ms",
               "colour, ms", "12 x 60, s");
  for (const std::string& name : simulated::preset_names()) {
    simulated::PresetOptions options;
    TRY_ASSIGN(const simulated::Preset preset, simulated::make_preset(name, 1, options));
    if (!pictures.empty()) {
      TRY(take_pictures(name, preset, pictures));
      continue;
    }
    // One complete calibration; for the others, a part suffices to show the speed.
    const bool is_whole = !is_quick && name == "cylinder126";
    TRY_ASSIGN(const Times t, measure(preset, is_whole ? 12 : 2, is_whole ? 60 : 8, is_whole));
    fmt::print("{:<20} {:>7.2f} {:>9.0f} {:>15.1f} {:>10.1f} {:>14.1f}{}\n", name, t.make_s, t.pose_ms, t.grey_ms,
               t.colour_ms, t.calibration_s, is_whole ? "" : "  (from the parts)");
    report[name] = {{"make_s", t.make_s},
                    {"pose_ms", t.pose_ms},
                    {"photograph_ms", t.grey_ms},
                    {"colour_ms", t.colour_ms},
                    {"calibration_s", t.calibration_s}};
  }
  if (pictures.empty()) fmt::print("{}\n", report.dump());
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  CLI::App app("How long simulated museums take, and what they look like.");
  bool is_quick = false;
  std::string pictures;
  app.add_flag("--quick", is_quick, "Less of each");
  app.add_option("--pictures", pictures, "Photograph each museum into this folder instead");
  CLI11_PARSE(app, argc, argv);
  const auto done = cyclorama::run(is_quick, pictures);
  if (!done) fmt::print(stderr, "museum_bench: {}\n", done.error().message());
  return done ? 0 : 1;
}
