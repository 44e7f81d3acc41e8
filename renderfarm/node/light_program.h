// SPDX-License-Identifier: Apache-2.0
/// The mode in which cyclorama-node runs as its own child: it computes the light of one scene and exits
/// (light_process.h).
#pragma once

#include <filesystem>
#include <functional>

#include "common/base/result.h"
#include "renderfarm/light_baking/light_pieces.h"
#include "renderfarm/node/light_computation.h"

namespace cyclorama::node {

/// Loads the scene and writes its light to `file`, completely or not at all. `progress` receives shares in [0, 1].
/// `pieces` decides which pieces are computed here; null: all. Errors: of the scene, of bake_light(), or kSystem if the
/// file cannot be written, with a remedy if the disk is full.
Status compute_light(const std::filesystem::path& scene, const std::filesystem::path& file, int threads,
                     const std::function<void(double)>& progress, light_baking::LightPieces* pieces = nullptr);

/// The same as a program: lowers its priority to the system's lowest, ends when its parent ends, gets orders for pieces
/// on standard input and reports on standard output (LightProcess).
Status run_light_program(const std::filesystem::path& scene, const std::filesystem::path& file, int threads);

/// Returns a function that starts this executable again with the options that node_main.cpp passes to
/// run_light_program().
[[nodiscard]] LightStarter light_process_starter(int threads);

inline constexpr const char* kLightOfOption = "--compute-light-of";
inline constexpr const char* kLightFileOption = "--light-file";

}  // namespace cyclorama::node
