// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/triangle_record.h"

#include <sys/mman.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace cyclorama::render {
namespace {

std::int16_t packed(float part) {
  return static_cast<std::int16_t>(std::lround(std::clamp(part, -1.0f, 1.0f) * 32767.0f));
}

TriangleRecord record_of(const scene::Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  TriangleRecord record{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t vertex = triangle[i];
    record.corners[i] = mesh.positions[vertex];
    if (!mesh.normals.empty()) {
      const std::array<float, 3>& n = mesh.normals[vertex];
      record.normals[i] = {packed(n[0]), packed(n[1]), packed(n[2])};
    }
    if (!mesh.colours.empty()) std::copy_n(mesh.colours[vertex].begin(), 3, record.colours[i].begin());
  }
  return record;
}

/// Requests huge pages, because scattered rays read records in random order, and with small pages each read also needs
/// a page-table walk. Failure is harmless.
void ask_for_huge_pages(void* data, std::size_t bytes) {
  constexpr std::uintptr_t kHugePage = std::uintptr_t{2} << 20;
  const auto from = (std::bit_cast<std::uintptr_t>(data) + kHugePage - 1) / kHugePage * kHugePage;
  const auto to = (std::bit_cast<std::uintptr_t>(data) + bytes) / kHugePage * kHugePage;
  if (from < to) ::madvise(std::bit_cast<void*>(from), to - from, MADV_HUGEPAGE);
}

}  // namespace

std::vector<TriangleRecord> make_triangle_records(const scene::Mesh& mesh) {
  std::vector<TriangleRecord> records;
  records.reserve(mesh.triangles.size());
  ask_for_huge_pages(records.data(), records.capacity() * sizeof(TriangleRecord));
  records.resize(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, records.size(),
                    [&](std::size_t i) { records[i] = record_of(mesh, mesh.triangles[i]); });
  return records;
}

}  // namespace cyclorama::render
