// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/stage_chain.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <utility>
#include <vector>

namespace cyclorama::light_baking {

struct StageChain::Hash {
  Hash() : state(XXH3_createState(), &XXH3_freeState) { XXH3_128bits_reset(state.get()); }
  void add(const void* bytes, std::size_t size) { XXH3_128bits_update(state.get(), bytes, size); }

  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state;
};

StageChain::StageChain(LightPieces& pieces) : pieces_(pieces), hash_(std::make_unique<Hash>()) {}
StageChain::~StageChain() = default;

void StageChain::add(std::span<const std::byte> bytes) {
  const std::size_t size = bytes.size();
  hash_->add(&size, sizeof(size));
  hash_->add(bytes.data(), size);
}

std::string StageChain::key() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(hash_->state.get());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

Status StageChain::begin() { return pieces_.begin(key()); }

Status StageChain::complete(std::uint32_t pieces, StageWork work) {
  if (pieces == 0) return Done{};
  std::vector<XXH128_hash_t> hashes(pieces);
  const auto take = std::move(work.take);
  work.take = [&](std::uint32_t piece, std::span<const std::byte> bytes) -> Status {
    TRY(take(piece, bytes));
    hashes[piece] = XXH3_128bits(bytes.data(), bytes.size());
    return Done{};
  };
  TRY(pieces_.complete({next_++, key(), pieces}, work));
  hash_->add(hashes.data(), hashes.size() * sizeof(XXH128_hash_t));
  return Done{};
}

}  // namespace cyclorama::light_baking
