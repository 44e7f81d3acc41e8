// SPDX-License-Identifier: Apache-2.0
/// Finished pieces of light on the disk, so that a computation that ended early goes on where it was. A file:
///
///   "CYCPIECE"  version u32  stage u32  piece u32  key of the stage, 32 characters
///   results;  XXH3 (128 bits) of all bytes before
///
/// Everything is little-endian.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "common/base/result.h"
#include "renderfarm/light_baking/light_pieces.h"

namespace cyclorama::light_baking {

/// A folder with the pieces of one computation. Reentrant once begun.
class PieceFolder {
 public:
  /// Nothing is created before a piece is saved.
  explicit PieceFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Removes the pieces of other computations, such as those of the scene before it changed.
  void begin(const std::string& computation);
  /// Returns the results; nothing if there is no such piece or its file is damaged.
  [[nodiscard]] std::optional<PieceBytes> load(const LightStage& stage, std::uint32_t piece) const;
  /// Errors: kSystem, with a remedy if the disk is full; everything saved before stays.
  [[nodiscard]] Status save(const LightStage& stage, std::uint32_t piece, std::span<const std::byte> results) const;
  [[nodiscard]] std::filesystem::path file_of(std::uint32_t stage, std::uint32_t piece) const;
  /// Removes the folder.
  void remove() const;

 private:
  const std::filesystem::path folder_;
  std::string computation_;
};

/// Returns the folder for the pieces of light that will be written to `file`.
[[nodiscard]] std::filesystem::path unfinished_light(const std::filesystem::path& file);

/// Computes pieces and keeps them in a folder; those that are there already are not computed.
class KeptPieces final : public LightPieces {
 public:
  explicit KeptPieces(std::filesystem::path folder) : folder_(std::move(folder)) {}
  Status begin(const std::string& computation) override;
  Status complete(const LightStage& stage, const StageWork& work) override;
  /// To be called once the light itself is in its file.
  void remove() const { folder_.remove(); }

 private:
  PieceFolder folder_;
};

}  // namespace cyclorama::light_baking
