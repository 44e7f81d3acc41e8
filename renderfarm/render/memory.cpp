// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/memory.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "common/base/text.h"

namespace cyclorama::render {
namespace {

/// Peak memory of the BVH while it is built, plus 64 bytes of TriangleRecord. Measured: 110 bytes with Embree 3.13 on
/// meshes of 0.7 to 6 million triangles; the rest is margin.
constexpr std::size_t kPeakBytesPerTriangle = 120 + 64;
constexpr std::size_t kBytesPerInstance = 1024;
/// Measured by `./bench.sh splats`: 64 bytes of record and some 80 of BVH once it is built; the rest is margin.
constexpr std::size_t kPeakBytesPerSplat = 400;
constexpr std::size_t kReserveBytes = std::size_t{64} << 20;

}  // namespace

std::optional<std::size_t> parse_available_memory(std::string_view meminfo) {
  constexpr std::string_view kField = "MemAvailable:";
  const std::size_t at = meminfo.find(kField);
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view rest = meminfo.substr(at + kField.size());
  rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  const auto kilobytes = parse_integer(rest.substr(0, rest.find_first_of(" \n")));
  if (!kilobytes || *kilobytes < 0) return std::nullopt;
  return static_cast<std::size_t>(*kilobytes) * 1024;
}

std::optional<std::size_t> available_memory() {
  // read_file() does not apply, because files in /proc have no size.
  std::ifstream file("/proc/meminfo");
  std::ostringstream text;
  text << file.rdbuf();
  return parse_available_memory(text.str());
}

std::size_t memory_for_bvh(std::size_t available) { return available > kReserveBytes ? available - kReserveBytes : 0; }

Status check_render_memory(std::string_view title, const RenderNeed& need, std::size_t available) {
  const std::size_t bvh =
      need.triangles * kPeakBytesPerTriangle + need.instances * kBytesPerInstance + need.splats * kPeakBytesPerSplat;
  const std::size_t free = memory_for_bvh(available);
  if (bvh <= free && need.mip_bytes <= free - bvh) return Done{};
  return Error(
      ErrorCode::kSystem,
      fmt::format("'{}' does not fit into memory: the BVH of its {:.1f} million triangles and splats needs about {}, "
                  "the smaller levels of its textures {}, and {} are free; take a coarser scene or a machine with more "
                  "memory",
                  printable(title), static_cast<double>(need.triangles + need.splats) / 1e6, describe_bytes(bvh),
                  describe_bytes(need.mip_bytes), describe_bytes(free)));
}

std::string describe_bytes(std::size_t bytes) {
  const double value = static_cast<double>(bytes);
  if (value >= 1e9) return fmt::format("{:.1f} GB", value / 1e9);
  if (value >= 1e6) return fmt::format("{:.1f} MB", value / 1e6);
  return fmt::format("{:.1f} kB", value / 1e3);
}

}  // namespace cyclorama::render
