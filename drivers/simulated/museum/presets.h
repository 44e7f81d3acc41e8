// SPDX-License-Identifier: Apache-2.0
/// Simulated museums to calibrate, drawn from a seed: each is an installation as an installer would describe it, and
/// the true one. Contains the truth: see truth.h for its permitted users.
///
///   cylinder126         the usual plan: radius 4.3 m, 126 degrees
///   not-quite-cylinder  the same, 4.06 to 4.6 m from its axis, as measured in a real museum
///   tilted              a cylinder that leans by 1.5 to 4 degrees
///   bumpy               a cylinder with waves and dents of some centimetres
///   plane, corner       flat; two flat walls that meet at 90 to 130 degrees
///   dome                a cap of a sphere, leaning towards the visitor
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/simulated/museum/truth.h"

namespace cyclorama::simulated {

struct PresetOptions {
  int projectors = 3;
  int projector_width_px = 1920;
  int projector_height_px = 1080;
  double camera_megapixels = 2.0;
  double overlap = 0.25;  ///< Overlap of neighbours, as a fraction of their width.
  bool has_flaws = true;  ///< If false, the optics are perfect; only the wall differs.
};

struct Preset {
  std::string installation_text;  ///< installation.toml
  Installation installation;      ///< Parsed `installation_text`.
  MuseumTruth truth;
};

[[nodiscard]] const std::vector<std::string>& preset_names();
/// Makes a museum; the same name, seed and options give the same museum. Errors: kInvalidArgument for an unknown name
/// or invalid options.
Result<Preset> make_preset(std::string_view name, std::uint32_t seed, const PresetOptions& options = {});
/// Writes installation.toml and truth.toml into an existing folder.
Status write_preset(const Preset& preset, const std::filesystem::path& folder);

}  // namespace cyclorama::simulated
