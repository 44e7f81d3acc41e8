// SPDX-License-Identifier: Apache-2.0
#include "common/image/radiance_file.h"

#include <fmt/format.h>

#include <string_view>

#include "common/base/file.h"
#include "common/image/openexr.h"
#include "common/image/pfm.h"
#include "common/image/radiance_hdr.h"

namespace cyclorama {

Result<RadianceImage> decode_radiance(std::span<const std::byte> bytes, std::size_t limit_px) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\x76\x2f\x31\x01")) return decode_openexr(bytes, limit_px);
  if (text.starts_with("#?")) return decode_radiance_hdr(bytes, limit_px);
  if (text.starts_with("PF") || text.starts_with("Pf")) {
    TRY_ASSIGN(RadianceImage image, decode_pfm(bytes, limit_px));
    for (float& value : image.data()) value = sane_radiance(value);
    return image;
  }
  return Error(ErrorCode::kBadData, "this is neither Radiance HDR, OpenEXR nor PFM; convert it to one of them");
}

Result<RadianceImage> read_radiance(const std::filesystem::path& path, std::size_t limit_px) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  auto image = decode_radiance(file.bytes(), limit_px);
  if (!image) return std::move(image).error().while_doing(fmt::format("reading picture '{}'", path.string()));
  return image;
}

}  // namespace cyclorama
