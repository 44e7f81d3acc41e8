// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace cyclorama {

/// Classes of work. A node renders a block of a later class only while it has none of an earlier one.
enum class WorkClass : std::uint8_t {
  kMoving,  ///< Pictures of visitors who move.
  kAtRest,  ///< Refinements of pictures of visitors who stand still.
  kSpare,   ///< All work beyond a museum's quota: it gets what all other work leaves.
};
inline constexpr std::size_t kWorkClasses = 3;

/// RenderBlock.rank: the class and, within the class, the position in its order, in cpu-microseconds of virtual time.
struct Rank {
  static constexpr std::uint64_t kPerClass = std::uint64_t{1} << 62;

  WorkClass work = WorkClass::kMoving;
  std::uint64_t position = 0;  ///< Below kPerClass.

  [[nodiscard]] static Rank of(std::uint64_t wire) {
    const std::uint64_t work = std::min<std::uint64_t>(wire / kPerClass, kWorkClasses - 1);
    return {static_cast<WorkClass>(work), std::min(wire - work * kPerClass, kPerClass - 1)};
  }
  [[nodiscard]] std::uint64_t wire() const { return static_cast<std::uint64_t>(work) * kPerClass + position; }
};

}  // namespace cyclorama
