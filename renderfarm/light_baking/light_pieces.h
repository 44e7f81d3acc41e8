// SPDX-License-Identifier: Apache-2.0
/// Divides the computation of light. It is a sequence of stages; each needs the results of all before, so a stage is a
/// barrier. A stage consists of pieces that do not depend on each other: whoever computes a piece, its bytes are the
/// same. Every host runs the whole sequence, and takes the results of a piece instead of computing it where they are
/// known already:
///
///     stage 0:  piece 0 │ piece 1 │ ...  ──all taken──►  stage 1:  piece 0 │ ...  ──►  ...  ──►  the light
///                 computed here, from an earlier run's file, or from another node
///
/// Cheap computations are not stages: every host does them by itself.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/base/result.h"
#include "renderfarm/light_baking/piece_bytes.h"

namespace cyclorama::light_baking {

struct LightStage {
  std::uint32_t number = 0;
  /// 32 hexadecimal digits, which name everything that the stage's results depend on: the scene, the settings, the
  /// program, and the results of the stages before. Results under another key are another computation's.
  std::string key;
  std::uint32_t pieces = 0;
};

/// Upper bound of the pieces of a stage.
inline constexpr std::uint32_t kMaxPieces = 256;

struct StageWork {
  /// Returns the results of a piece. Reentrant. Errors: kUnavailable if the computation was cancelled.
  std::function<Result<PieceBytes>(std::uint32_t piece)> compute;
  /// Takes results; to be called until it succeeds once for each piece, from any thread. Errors: kBadData if the bytes
  /// are no results of that piece.
  std::function<Status(std::uint32_t piece, std::span<const std::byte> bytes)> take;
  bool in_parallel = true;  ///< False if the work on one piece uses all threads by itself.
};

/// Decides where the results of pieces come from. Thread-bound; it uses the threads of the TBB arena in which it is
/// called.
class LightPieces {
 public:
  virtual ~LightPieces() = default;
  /// To be called first; `computation` is the key of the first stage.
  virtual Status begin(const std::string& computation) = 0;
  /// Returns when all pieces of the stage are taken. Errors: those of computing a piece, or of keeping it.
  virtual Status complete(const LightStage& stage, const StageWork& work) = 0;

 protected:
  LightPieces() = default;
  LightPieces(const LightPieces&) = default;
  LightPieces& operator=(const LightPieces&) = default;
};

/// Computes all pieces and keeps none.
class ComputedPieces final : public LightPieces {
 public:
  Status begin(const std::string&) override { return Done{}; }
  Status complete(const LightStage& stage, const StageWork& work) override;
};

/// Calls `call` for pieces, in parallel if the work allows it. Returns an error if there was one; then some pieces may
/// be left out.
Status for_pieces(std::span<const std::uint32_t> pieces, bool in_parallel,
                  const std::function<Status(std::uint32_t piece)>& call);
/// Returns 0, 1, ... up to the stage's last piece.
[[nodiscard]] std::vector<std::uint32_t> all_pieces(const LightStage& stage);

/// Cuts a number of items into pieces of consecutive ones.
class PieceCut {
 public:
  /// A piece has `per_piece` items, or more if there would be more than kMaxPieces pieces.
  PieceCut(std::size_t items, std::size_t per_piece)
      : items_(items), per_piece_(std::max(per_piece, (items + kMaxPieces - 1) / kMaxPieces)) {}
  [[nodiscard]] std::uint32_t pieces() const {
    return static_cast<std::uint32_t>((items_ + per_piece_ - 1) / per_piece_);
  }
  [[nodiscard]] std::size_t first(std::uint32_t piece) const { return piece * per_piece_; }
  [[nodiscard]] std::size_t end(std::uint32_t piece) const { return std::min(first(piece) + per_piece_, items_); }

 private:
  std::size_t items_;
  std::size_t per_piece_;
};

}  // namespace cyclorama::light_baking
