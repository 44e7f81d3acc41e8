// SPDX-License-Identifier: Apache-2.0
/// A grotto on disk: a scene package, written completely or not at all.
#pragma once

#include <filesystem>

#include "renderfarm/generator/grotto.h"

namespace cyclorama::generator {

struct PackageOrder {
  Kind kind = Kind::kGrotto;
  std::uint64_t triangles = 1'000'000;
  std::uint32_t seed = 1;
  int lamps = 4;  ///< Number of lamps of an interior; other kinds have fixed lamps.
  std::filesystem::path folder;
  bool replace = false;  ///< Allows replacing an older grotto at `folder`; anything else there is never replaced.
  int threads = 1;
};

struct PackageReport {
  GeometryCounts counts;
  std::uint64_t bytes = 0;
};

/// Writes the package into a new folder beside the target and renames that folder, so that a stopped or failed run
/// leaves the target unchanged.
///
/// Errors:
/// kInvalidArgument  the number of triangles is out of range.
/// kBusy             `folder` exists and is not an empty folder or, with `replace`, not a grotto.
/// kNotFound         the parent folder does not exist.
/// kUnavailable      `keep_going` returned false.
/// kSystem           the disk is full or reports an error.
Result<PackageReport> write_package(const PackageOrder& order, const KeepGoing& keep_going);

}  // namespace cyclorama::generator
