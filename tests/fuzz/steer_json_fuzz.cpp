// SPDX-License-Identifier: Apache-2.0
/// Arbitrary steering requests of a page.
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "kiosk/operator/status_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto wanted = cyclorama::operations::parse_steer({reinterpret_cast<const char*>(data), size});
  if (wanted) {
    for (const double value : {wanted->forward(), wanted->right(), wanted->turn()}) CHECK(std::abs(value) <= 1.0);
  } else {
    CHECK(!wanted.error().message().empty());
  }
  return 0;
}
