// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "kiosk/operator/healing_controller.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  wire::ProcessStatus status;
  if (!status.ParseFromArray(data, static_cast<int>(size))) return 0;
  CHECK(!operations::watched_json(status).empty());
  return 0;
}
