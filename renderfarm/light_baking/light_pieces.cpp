// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/light_pieces.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <mutex>
#include <numeric>
#include <optional>
#include <vector>

namespace cyclorama::light_baking {

Status for_pieces(std::span<const std::uint32_t> pieces, bool in_parallel,
                  const std::function<Status(std::uint32_t piece)>& call) {
  if (!in_parallel) {
    for (const std::uint32_t piece : pieces) TRY(call(piece));
    return Done{};
  }
  std::atomic<bool> has_failed = false;
  std::mutex mutex;
  std::optional<Error> first;
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
    if (has_failed) return;
    if (const Status done = call(pieces[i]); !done) {
      const std::lock_guard lock(mutex);
      if (!has_failed.exchange(true)) first = done.error();
    }
  });
  if (first) return *std::move(first);
  return Done{};
}

std::vector<std::uint32_t> all_pieces(const LightStage& stage) {
  std::vector<std::uint32_t> all(stage.pieces);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

Status ComputedPieces::complete(const LightStage& stage, const StageWork& work) {
  return for_pieces(all_pieces(stage), work.in_parallel, [&](std::uint32_t piece) -> Status {
    TRY_ASSIGN(const PieceBytes bytes, work.compute(piece));
    return work.take(piece, bytes);
  });
}

}  // namespace cyclorama::light_baking
