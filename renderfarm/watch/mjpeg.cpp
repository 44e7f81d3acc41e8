// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/mjpeg.h"

#include <fmt/format.h>

#include <iterator>

namespace cyclorama::watch {
namespace {
constexpr const char* kBoundary = "--cyclorama-picture\r\n";
}

std::string mjpeg_begin() { return kBoundary; }

std::string mjpeg_part(std::span<const std::byte> jpeg) {
  std::string part;
  part.reserve(jpeg.size() + 128);
  fmt::format_to(std::back_inserter(part), "Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.size());
  for (const std::byte byte : jpeg) part.push_back(static_cast<char>(byte));
  part += "\r\n";
  part += kBoundary;
  return part;
}

}  // namespace cyclorama::watch
