// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "appliance/scan/scan_view.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto manifest = scan::parse_manifest({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (manifest) {
    // An accepted manifest is unchanged by a round trip.
    const std::string written = scan::manifest_text(*manifest);
    const auto back = scan::parse_manifest(written, "fuzz");
    CHECK(back.has_value() && scan::manifest_text(*back) == written);
  } else {
    CHECK(manifest.error().message().find("; ") != std::string::npos);
  }
  const scan::ScanIdentity identity{"camera", 640, 480, {{"left", 320, 200}}, {0.0}, ""};
  const auto correspondences =
      scan::decode_correspondences({reinterpret_cast<const std::byte*>(data), size}, identity, 0);
  if (correspondences) CHECK(scan::encode_correspondences(*correspondences).size() == size);
  return 0;
}
