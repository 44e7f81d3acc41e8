// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/triangle_record.h"

#include <sys/mman.h>
#include <tbb/parallel_for.h>

#include <bit>

namespace cyclorama::render {
namespace {

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
  const VertexArrays vertices{mesh.positions.data(), mesh.normals.empty() ? nullptr : mesh.normals.data(),
                              mesh.colours.empty() ? nullptr : mesh.colours.data()};
  tbb::parallel_for(std::size_t{0}, records.size(),
                    [&](std::size_t i) { read_triangle(vertices, mesh.triangles[i], &records[i]); });
  return records;
}

}  // namespace cyclorama::render
