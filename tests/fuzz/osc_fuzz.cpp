// SPDX-License-Identifier: Apache-2.0
/// Any packet is rejected, or yields messages that are bit-identical after a round trip.
#include <cstddef>
#include <cstdint>
#include <span>

#include "appliance/tracker/interchange/osc_pose.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  const auto messages = tracker::decode_osc(std::as_bytes(std::span(data, size)));
  if (!messages) return 0;
  for (const tracker::OscMessage& message : *messages) {
    const auto again = tracker::decode_osc(tracker::encode_osc(message));
    CHECK(again && again->size() == 1 && again->front().address == message.address);
    CHECK(tracker::encode_osc(again->front()) == tracker::encode_osc(message));
    if (const auto pose = tracker::pose_from_osc(message))
      static_cast<void>(tracker::pose_of(*pose, tracker::TrackerAxes::kRoom));
    if (const auto steer = tracker::steer_from_osc(message)) CHECK((*steer)[0] >= -1.0 && (*steer)[0] <= 1.0);
  }
  return 0;
}
