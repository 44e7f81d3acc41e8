// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/pipe_plan.h"

#include <array>

#include "common/base/check.h"

namespace cyclorama::output {
namespace {

constexpr std::size_t kCrtcs = 32;  // Number of bits in a mask.

/// Kuhn's algorithm for bipartite matching: a connector takes a CRTC whose owner finds another one.
class Matching {
 public:
  explicit Matching(std::span<const std::uint32_t> possible) : possible_(possible) { owner_.fill(kNobody); }

  void take(std::size_t connector, std::size_t crtc) { owner_[crtc] = connector; }
  [[nodiscard]] bool can_take(std::size_t connector, std::size_t crtc) const {
    return crtc < kCrtcs && owner_[crtc] == kNobody && (possible_[connector] >> crtc & 1U) != 0;
  }
  [[nodiscard]] std::optional<std::size_t> crtc_of(std::size_t connector) const {
    for (std::size_t crtc = 0; crtc < kCrtcs; ++crtc) {
      if (owner_[crtc] == connector) return crtc;
    }
    return std::nullopt;
  }
  bool find(std::size_t connector) {
    seen_ = 0;
    return augment(connector);
  }

 private:
  static constexpr std::size_t kNobody = SIZE_MAX;

  bool augment(std::size_t connector) {
    // A free one first, since a head that changes its CRTC goes dark for a moment.
    for (std::size_t crtc = 0; crtc < kCrtcs; ++crtc) {
      if (!can_take(connector, crtc)) continue;
      owner_[crtc] = connector;
      return true;
    }
    for (std::size_t crtc = 0; crtc < kCrtcs; ++crtc) {
      if (!can_try(connector, crtc)) continue;
      seen_ |= 1U << crtc;
      if (owner_[crtc] != kNobody && !augment(owner_[crtc])) continue;
      owner_[crtc] = connector;
      return true;
    }
    return false;
  }
  [[nodiscard]] bool can_try(std::size_t connector, std::size_t crtc) const {
    return ((possible_[connector] & ~seen_) >> crtc & 1U) != 0;
  }

  std::span<const std::uint32_t> possible_;
  std::array<std::size_t, kCrtcs> owner_{};
  std::uint32_t seen_ = 0;
};

}  // namespace

std::vector<std::optional<std::size_t>> assign_crtcs(std::span<const std::uint32_t> possible_crtcs,
                                                     std::span<const std::optional<std::size_t>> keep) {
  CHECK(keep.empty() || keep.size() == possible_crtcs.size());
  Matching matching(possible_crtcs);
  const std::size_t count = possible_crtcs.size();
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] && matching.can_take(i, *keep[i])) matching.take(i, *keep[i]);
  }
  // An augmenting path takes a CRTC from an owner only if the owner gets another one, so no owner loses out.
  for (std::size_t i = 0; i < count; ++i) {
    if (!matching.crtc_of(i)) matching.find(i);
  }
  std::vector<std::optional<std::size_t>> assigned;
  for (std::size_t i = 0; i < count; ++i) assigned.push_back(matching.crtc_of(i));
  return assigned;
}

}  // namespace cyclorama::output
