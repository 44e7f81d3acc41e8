// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <string>

#include "renderfarm/generator/geometry_sink.h"

namespace cyclorama::generator {

/// A summary of one file, with which a grotto of any size can be checked without storing it.
struct RecordedFile {
  generator::GeometryCounts promised;
  generator::GeometryCounts arrived;
  std::uint64_t digest = 14695981039346656037u;  ///< FNV-1a over positions, normals, colours and indices, in order.
  std::uint64_t bad_numbers = 0;  ///< Number of vertices that are not finite or whose normal is not of unit length.
  std::uint64_t bad_indices = 0;  ///< Number of triangles that name a vertex twice or name one that does not exist.
  std::size_t max_call = 0;       ///< Maximum number of vertices or triangles in one call.
  std::array<float, 3> low{1e9f, 1e9f, 1e9f};
  std::array<float, 3> high{-1e9f, -1e9f, -1e9f};
  bool finished = false;
};

/// A geometry sink that counts and checks without storing. Thread-safe.
class RecordingSink final : public generator::GeometrySink {
 public:
  Result<std::unique_ptr<generator::GeometryFile>> open(const std::string& name,
                                                        const generator::GeometryCounts& counts) override {
    const std::lock_guard lock(mutex_);
    RecordedFile& file = files_[name];  // References to a map's elements remain valid.
    file.promised = counts;
    return std::unique_ptr<generator::GeometryFile>(std::make_unique<File>(file));
  }

  /// Returns the summaries; valid once all files are finished.
  [[nodiscard]] const std::map<std::string, RecordedFile>& files() const { return files_; }

 private:
  class File final : public generator::GeometryFile {
   public:
    explicit File(RecordedFile& counted) : counted_(counted) {}

    Status add_vertices(std::span<const generator::Vertex> vertices) override {
      counted_.arrived.vertices += vertices.size();
      counted_.max_call = std::max(counted_.max_call, vertices.size());
      for (const generator::Vertex& vertex : vertices) add(vertex);
      return Done{};
    }

    Status add_triangles(std::span<const generator::Triangle> triangles) override {
      counted_.arrived.triangles += triangles.size();
      counted_.max_call = std::max(counted_.max_call, triangles.size());
      for (const generator::Triangle& t : triangles) {
        const bool bad = *std::max_element(t.begin(), t.end()) >= counted_.promised.vertices || t[0] == t[1] ||
                         t[1] == t[2] || t[2] == t[0];
        counted_.bad_indices += bad ? 1u : 0u;
        digest(t.data(), sizeof t);
      }
      return Done{};
    }

    Status finish() override {
      counted_.finished = true;
      return Done{};
    }

   private:
    void add(const generator::Vertex& vertex) {
      float length = 0.0f;
      bool finite = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float p = vertex.position[axis];
        finite = finite && std::isfinite(p);
        counted_.low[axis] = std::min(counted_.low[axis], p);
        counted_.high[axis] = std::max(counted_.high[axis], p);
        length += vertex.normal[axis] * vertex.normal[axis];
      }
      counted_.bad_numbers += finite && std::abs(length - 1.0f) < 1e-4f ? 0u : 1u;
      digest(vertex.position.data(), 12);
      digest(vertex.normal.data(), 12);
      digest(vertex.colour.data(), 3);
    }

    void digest(const void* data, std::size_t size) {
      const auto* const bytes = static_cast<const unsigned char*>(data);
      for (std::size_t i = 0; i < size; ++i) counted_.digest = (counted_.digest ^ bytes[i]) * 1099511628211u;
    }

    RecordedFile& counted_;
  };

  std::mutex mutex_;
  std::map<std::string, RecordedFile> files_;
};

}  // namespace cyclorama::generator
