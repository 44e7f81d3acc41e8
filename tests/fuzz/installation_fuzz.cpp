// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/base/check.h"
#include "common/room/installation.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto installation = cyclorama::parse_installation(text, "installation.toml");
  if (installation) CHECK(validate(installation->picture(1024)).has_value());
  return 0;
}
