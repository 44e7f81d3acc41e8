// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "common/base/text.h"
#include "renderfarm/render/triangle_record.h"

namespace cyclorama::render {
namespace {

/// Peak memory that the BVH reserves while it is built. It was measured as 110 and 68 bytes with Embree 3.13 on meshes
/// of 0.7 to 6 million triangles; the rest is margin. The compact one touches 37 bytes of them.
constexpr std::size_t kPeakBytesPerTriangle = 120;
constexpr std::size_t kPeakCompactBytesPerTriangle = 72;
constexpr std::size_t kBytesPerInstance = 1024;
/// `./bench.sh splats` measures 64 bytes of record and about 80 of BVH once it is built; the rest is margin.
constexpr std::size_t kPeakBytesPerSplat = 400;
constexpr std::size_t kReserveBytes = std::size_t{64} << 20;

/// Returns a file's text; empty if it cannot be read. read_file() does not apply: files in /proc have no size.
std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::optional<std::size_t> bytes_of(std::string_view text) {
  const auto value = parse_integer(text.substr(0, text.find('\n')));
  if (!value || *value < 0) return std::nullopt;
  return static_cast<std::size_t>(*value);
}

/// Returns the bytes of inactive file pages that memory.stat reports.
std::size_t reclaimable_bytes(const std::string& stat) {
  constexpr std::string_view kField = "inactive_file ";
  std::istringstream lines(stat);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kField)) return bytes_of(std::string_view(line).substr(kField.size())).value_or(0);
  }
  return 0;
}

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

std::optional<std::size_t> cgroup_memory(const std::filesystem::path& root) {
  constexpr std::string_view kUnified = "0::/";
  std::string path;
  std::istringstream groups(text_of(root / "proc/self/cgroup"));
  for (std::string line; std::getline(groups, line);) {
    if (line.starts_with(kUnified)) path = line.substr(kUnified.size());
  }
  const std::filesystem::path top = root / "sys/fs/cgroup";
  std::optional<std::size_t> least;
  for (std::filesystem::path group = path.empty() ? top : top / path;; group = group.parent_path()) {
    const auto max = bytes_of(text_of(group / "memory.max"));  // "max" means that there is no limit.
    const auto used = bytes_of(text_of(group / "memory.current"));
    if (max && used) {
      const std::size_t held = *used - std::min(*used, reclaimable_bytes(text_of(group / "memory.stat")));
      least = std::min(least.value_or(*max), *max - std::min(*max, held));
    }
    if (group == top || !group.has_relative_path()) return least;
  }
}

std::optional<std::size_t> available_memory(const std::filesystem::path& root) {
  const auto machine = parse_available_memory(text_of(root / "proc/meminfo"));
  const auto group = cgroup_memory(root);
  if (machine && group) return std::min(*machine, *group);
  return machine ? machine : group;
}

std::size_t memory_for_bvh(std::size_t available) { return available > kReserveBytes ? available - kReserveBytes : 0; }

std::string_view name_of(MemoryMode mode) {
  if (mode == MemoryMode::kFast) return "fast";
  return mode == MemoryMode::kMedium ? "medium" : "compact";
}

Result<MemoryMode> choose_memory_mode(std::string_view title, const RenderNeed& need, std::size_t available,
                                      std::optional<MemoryMode> wanted) {
  const std::size_t free = memory_for_bvh(available);
  std::size_t bvh = 0;
  for (const MemoryMode mode : kMemoryModes) {
    if (wanted && *wanted != mode) continue;
    std::size_t of_triangle = mode == MemoryMode::kCompact ? kPeakCompactBytesPerTriangle : kPeakBytesPerTriangle;
    if (mode == MemoryMode::kFast) of_triangle += sizeof(TriangleRecord);
    bvh = need.triangles * of_triangle + need.instances * kBytesPerInstance + need.splats * kPeakBytesPerSplat;
    if (bvh <= free && need.mip_bytes <= free - bvh) return mode;
  }
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
