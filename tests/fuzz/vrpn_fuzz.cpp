// SPDX-License-Identifier: Apache-2.0
/// Arbitrary datagrams in sequence; the first byte of each is its length.
#include <cstddef>
#include <cstdint>
#include <span>

#include "appliance/tracker/interchange/vrpn.h"
#include "common/base/check.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cyclorama::FuzzInput input(data, size);
  cyclorama::tracker::VrpnReader reader("");
  while (!input.is_empty()) {
    const std::size_t length = 4 * input.byte();
    const auto reports = reader.read(std::as_bytes(input.bytes(length)));
    if (!reports) continue;
    for (const auto& report : *reports) {
      CHECK(report.found);
      static_cast<void>(cyclorama::tracker::pose_of(report, cyclorama::tracker::TrackerAxes::kCamera));
    }
  }
  return 0;
}
