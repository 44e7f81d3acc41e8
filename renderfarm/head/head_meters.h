// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"
#include "common/wire/inspection_service.h"
#include "renderfarm/head/head_state.h"
#include "renderfarm/head/peers.h"

namespace cyclorama {

/// The head's numbers for the operator. Thread-bound: the head's loop; the service it feeds is borrowed.
class HeadMeters {
 public:
  explicit HeadMeters(InspectionService& inspection) : inspection_(inspection) {}
  void add(const FrameReport& report);
  void add_relay(double seconds);
  /// Rates are means since the last call at least a second ago.
  void update(const HeadState& state, TimePoint now);

 private:
  InspectionService& inspection_;
  TimePoint updated_at_{};
  int frames_ = 0;
  std::uint64_t rays_ = 0;
};

}  // namespace cyclorama
