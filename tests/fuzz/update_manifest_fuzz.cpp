// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/update/update_manifest.h"

/// Manifests from a farm or a USB stick: rejected, or three valid file names.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto manifest = parse_update_manifest(text, "a");
  if (!manifest) return 0;
  if (!is_image_version(manifest->version) || is_newer(manifest->version, manifest->version)) std::abort();
  for (const UpdateFile& file : manifest->files) {
    if (file.sha256.size() != 64 || file.name.find('/') != std::string::npos || !file.name.starts_with("a_"))
      std::abort();
  }
  return 0;
}
