// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/base/result.h"
#include "renderfarm/light_baking/light_pieces.h"

namespace cyclorama::light_baking {

/// Gives the stages of a computation their keys: each is a hash (XXH3, 128 bits) of the one before and of all that was
/// added or taken since. So hosts that round differently, or have another program, never mix their results.
/// Thread-bound.
class StageChain {
 public:
  /// Borrows `pieces`.
  explicit StageChain(LightPieces& pieces);
  ~StageChain();
  StageChain(const StageChain&) = delete;
  StageChain& operator=(const StageChain&) = delete;

  /// Adds something that every host has computed by itself and on which the results of later stages depend.
  void add(std::span<const std::byte> bytes);
  /// Begins with what has been added as the key.
  Status begin();
  /// Completes a stage of so many pieces; does nothing if there are none. Errors: as LightPieces::complete().
  Status complete(std::uint32_t pieces, StageWork work);

 private:
  struct Hash;
  [[nodiscard]] std::string key() const;

  LightPieces& pieces_;
  std::unique_ptr<Hash> hash_;
  std::uint32_t next_ = 0;
};

}  // namespace cyclorama::light_baking
