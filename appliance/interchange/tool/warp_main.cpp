// SPDX-License-Identifier: Apache-2.0
/// cyclorama-warp: converts calibrations of projectors from and to the formats of other programs.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>

#include "appliance/interchange/display_warp.h"
#include "appliance/interchange/mpcdi.h"
#include "appliance/interchange/mpcdi_words.h"
#include "appliance/interchange/warp_file.h"
#include "appliance/interchange/warp_picture.h"
#include "common/image/png.h"
#include "common/process/program.h"
#include "common/room/installation.h"

namespace cyclorama::interchange {
namespace {

struct Arguments {
  std::string in;
  std::string out;
  std::string region;
  std::string png;
  std::string mask;
  int columns = 0;
  int rows = 0;
  WarpFileOptions options;
};

void add_reading_options(CLI::App* command, Arguments* arguments) {
  command->add_option("--width", arguments->options.width_px, "The projector's width in pixels, for meshes")
      ->check(CLI::Range(1, 16384))
      ->capture_default_str();
  command->add_option("--height", arguments->options.height_px, "Its height")
      ->check(CLI::Range(1, 16384))
      ->capture_default_str();
  command->add_option("--mask", arguments->mask, "The PNG that belongs to a PFM: how much light each pixel gives");
  command->add_flag_callback(
      "--in-space", [arguments] { arguments->options.profile = WarpProfile::kAdvanced3d; },
      "A PFM holds points in space, not positions in a picture");
  command->add_option("--region", arguments->region, "Which region (projector), where a file has several");
}

void list_ignored(const WarpFile& file) {
  for (const std::string& line : file.ignored) fmt::print("ignored: {}\n", line);
}

void list_region(const WarpRegion& region) {
  const auto mask = [](const std::optional<MaskMap>& map) {
    return map ? fmt::format("{}x{}, {} bits, gamma {}", map->width_px, map->height_px, map->bits, map->gamma) : "none";
  };
  fmt::print("region '{}': {}x{} pixels, at {} {}, {} by {} of the picture\n", region.id, region.width_px,
             region.height_px, region.rect.x, region.rect.y, region.rect.width, region.rect.height);
  if (region.map) {
    fmt::print("  map         {}x{}, {:.1f} % mapped, unit {}, from {}\n", region.map->width(), region.map->height(),
               100.0 * mapped_fraction(region), mpcdi::word_of(mpcdi::kUnits, region.unit),
               mpcdi::word_of(mpcdi::kOrigins, region.origin));
  } else {
    fmt::print("  map         none: only the projector's pose\n");
  }
  fmt::print("  alpha       {}\n  beta        {}\n", mask(region.alpha), mask(region.beta));
  if (region.frustum) {
    const WarpFrustum& f = *region.frustum;
    fmt::print("  frustum     yaw {} pitch {} roll {}; {} to {} across, {} to {} up, degrees\n", f.yaw_deg, f.pitch_deg,
               f.roll_deg, f.left_deg, f.right_deg, f.down_deg, f.up_deg);
  }
  if (region.coordinate_frame) {
    const auto& p = region.coordinate_frame->position;
    fmt::print("  position    {} {} {}\n", p[0], p[1], p[2]);
  }
}

Status show(const Arguments& arguments) {
  TRY_ASSIGN(const WarpFile file, read_warp_file(arguments.in, arguments.options));
  fmt::print("profile {}\n", mpcdi::word_of(mpcdi::kProfiles, file.set.profile));
  const WarpRegion* drawn = nullptr;
  for (const WarpBuffer& buffer : file.set.buffers) {
    fmt::print("buffer '{}'\n", buffer.id);
    for (const WarpRegion& region : buffer.regions) {
      list_region(region);
      if (drawn == nullptr && region.map && (arguments.region.empty() || arguments.region == region.id)) {
        drawn = &region;
      }
    }
  }
  list_ignored(file);
  if (arguments.png.empty()) return Done{};
  if (drawn == nullptr) return Error(ErrorCode::kNotFound, "no such region has a map to draw");
  return write_png(arguments.png, picture_of(*drawn));
}

Status convert(Arguments arguments) {
  TRY_ASSIGN(const WarpFile file, read_warp_file(arguments.in, arguments.options));
  list_ignored(file);
  arguments.options.mask.reset();  // The option is the mask to read, not the mask to write.
  if (arguments.columns > 0 || arguments.rows > 0) {
    arguments.options.grid = {arguments.columns > 0 ? arguments.columns : kDefaultGrid.columns,
                              arguments.rows > 0 ? arguments.rows : kDefaultGrid.rows};
  }
  return write_warp_file(arguments.out, file, arguments.region, arguments.options);
}

Status write_room(const Arguments& arguments) {
  TRY_ASSIGN(const Installation installation, read_installation(arguments.in));
  WarpSet set = set_of(installation);
  set.version = arguments.options.version;
  set.date = fmt::format("{:%Y-%m-%d %H:%M:%S}",
                         fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  return write_mpcdi(arguments.out, set);
}

}  // namespace
}  // namespace cyclorama::interchange

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::interchange;  // NOLINT(google-build-using-namespace)
  Program program("cyclorama-warp",
                  "Converts calibrations of projectors from and to other programs: MPCDI, PFM with PNG, Bourke .data, "
                  "OBJ, domeprojection CSV, SimCAD.");
  CLI::App* const options = &program.options();
  options->require_subcommand(1);
  Arguments arguments;
  CLI::App* const shown = options->add_subcommand("show", "Print what a file holds, and draw a region");
  shown->add_option("file", arguments.in, "The file: .mpcdi .xml .pfm .data .obj .csv .simcad")->required();
  shown->add_option("--png", arguments.png, "Draw the first region, or --region, into this picture");
  add_reading_options(shown, &arguments);
  CLI::App* const converted = options->add_subcommand("convert", "Read one format and write another");
  converted->add_option("in", arguments.in, "The file that is read")->required();
  converted->add_option("out", arguments.out, "The file that is written: .mpcdi .pfm .data .obj")->required();
  add_reading_options(converted, &arguments);
  converted
      ->add_option("--columns", arguments.columns, "Nodes across of a written mesh; default: as read, otherwise 65")
      ->check(CLI::Range(2, 4096));
  converted->add_option("--rows", arguments.rows, "Nodes down; default: as read, otherwise 37")
      ->check(CLI::Range(2, 4096));
  CLI::App* const room =
      options->add_subcommand("room", "Write an installation's projectors as MPCDI a3, for other engines");
  room->add_option("in", arguments.in, "installation.toml")->required();
  room->add_option("out", arguments.out, "The .mpcdi file that is written")->required();
  for (CLI::App* const writer : {converted, room}) {
    writer->add_flag_callback(
        "--mpcdi-1", [&] { arguments.options.version = MpcdiVersion::k1_0; }, "Write MPCDI 1.0 instead of 2.0");
  }
  return program.run(argc, argv, [&](const StopSignal&) -> Status {
    if (!arguments.mask.empty()) arguments.options.mask = arguments.mask;
    if (room->parsed()) return write_room(arguments);
    return shown->parsed() ? show(arguments) : convert(arguments);
  });
}
