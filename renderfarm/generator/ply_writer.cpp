// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/ply_writer.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <vector>

#include "common/base/unique_fd.h"

namespace cyclorama::generator {
namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 20;
constexpr std::size_t kPlaceBytes = 12;
constexpr std::size_t kNormalBytes = 12;
constexpr std::size_t kColourBytes = 3;
constexpr std::size_t kTriangleBytes = 13;
static_assert(std::endian::native == std::endian::little, "numbers are copied in their memory representation");

std::string header_of(const GeometryCounts& counts, Shading shading) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment made by cyclorama-grotto\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "{}property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      counts.vertices, shading == Shading::kSmooth ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
      counts.triangles);
}

class PlyFile final : public GeometryFile {
 public:
  PlyFile(UniqueFd fd, std::filesystem::path path, Shading shading)
      : fd_(std::move(fd)), path_(std::move(path)), shading_(shading) {
    buffer_.reserve(kBuffer);
  }

  Status add_text(std::string_view text) { return add(text.data(), text.size()); }

  Status add_vertices(std::span<const Vertex> vertices) override {
    for (const Vertex& vertex : vertices) {
      TRY(add(vertex.position.data(), kPlaceBytes));
      if (shading_ == Shading::kSmooth) TRY(add(vertex.normal.data(), kNormalBytes));
      TRY(add(vertex.colour.data(), kColourBytes));
    }
    return Done{};
  }

  Status add_triangles(std::span<const Triangle> triangles) override {
    for (const Triangle& triangle : triangles) {
      std::array<std::byte, kTriangleBytes> bytes;
      bytes[0] = std::byte{3};
      std::memcpy(bytes.data() + 1, triangle.data(), 12);
      TRY(add(bytes.data(), bytes.size()));
    }
    return Done{};
  }

  Status finish() override {
    TRY(flush());
    // Some file systems report a full disk only here.
    if (::fdatasync(fd_.get()) != 0) return Error::from_errno(fmt::format("writing '{}'", path_.string()));
    fd_.reset();
    return Done{};
  }

 private:
  Status add(const void* data, std::size_t size) {
    if (buffer_.size() + size > kBuffer) TRY(flush());
    const auto* const bytes = static_cast<const std::byte*>(data);
    buffer_.insert(buffer_.end(), bytes, bytes + size);
    return Done{};
  }

  Status flush() {
    std::size_t done = 0;
    while (done < buffer_.size()) {
      const ssize_t n = ::write(fd_.get(), buffer_.data() + done, buffer_.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return Error::from_errno(fmt::format("writing '{}'", path_.string()));
      done += static_cast<std::size_t>(n);
    }
    buffer_.clear();
    return Done{};
  }

  UniqueFd fd_;
  std::filesystem::path path_;
  Shading shading_;
  std::vector<std::byte> buffer_;
};

}  // namespace

std::uint64_t ply_bytes(const GeometryCounts& counts, Shading shading) {
  const std::size_t vertex = kPlaceBytes + (shading == Shading::kSmooth ? kNormalBytes : 0) + kColourBytes;
  return header_of(counts, shading).size() + vertex * counts.vertices + kTriangleBytes * counts.triangles;
}

Result<std::unique_ptr<GeometryFile>> PlySink::open(const std::string& name, const GeometryCounts& counts) {
  const std::filesystem::path path = folder_ / name;
  UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (!fd.is_open()) return Error::from_errno(fmt::format("creating '{}'", path.string()));
  auto file = std::make_unique<PlyFile>(std::move(fd), path, shading_);
  TRY(file->add_text(header_of(counts, shading_)));
  return std::unique_ptr<GeometryFile>(std::move(file));
}

}  // namespace cyclorama::generator
