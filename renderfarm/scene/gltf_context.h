// SPDX-License-Identifier: Apache-2.0
/// State shared by all parts of one glTF import: the remaining memory budget, and the notes for the user.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Memory budget, which is charged before memory is allocated for anything whose size depends on the file. Up to 4 GiB
/// of the limit are available from the start; the rest is released in proportion to the bytes that the import reads, so
/// that a small file cannot claim the memory of a whole machine. Thread-bound.
class GltfBudget {
 public:
  explicit GltfBudget(std::size_t limit_bytes)
      : limit_bytes_(limit_bytes),
        left_bytes_(std::min(limit_bytes, kFreeBytes)),
        withheld_bytes_(limit_bytes - left_bytes_) {}

  /// Releases up to kBytesPerStored bytes of the limit for each of the `stored` bytes that the import reads.
  void earn(std::uint64_t stored);

  /// Charges `count` items of `bytes_each`; `place` is named in errors. Errors: kBadData if the budget has less left.
  Status take(std::string_view place, std::uint64_t count, std::size_t bytes_each);
  /// Returns memory that was taken temporarily to the budget.
  void give_back(std::uint64_t count, std::size_t bytes_each) { left_bytes_ += count * bytes_each; }
  [[nodiscard]] std::size_t left_bytes() const { return left_bytes_; }

 private:
  static constexpr std::size_t kFreeBytes = std::size_t{4} << 30;
  static constexpr std::size_t kBytesPerStored = 64;  ///< For example, a triangle takes 1 byte in Draco and 40 decoded.

  std::size_t limit_bytes_;
  std::size_t left_bytes_;
  std::size_t withheld_bytes_;
};

/// Collects Model::notes. A sentence that applies to many places becomes one note. Thread-bound.
class GltfNotes {
 public:
  void add(const std::string& sentence, std::string_view place);
  [[nodiscard]] std::vector<std::string> sentences() const;

 private:
  struct Occurrence {
    std::size_t order = 0;
    std::size_t count = 0;
    std::string first_place;
  };
  std::map<std::string, Occurrence> notes_;
  std::size_t left_out_ = 0;
};

struct GltfContext {
  explicit GltfContext(const ImportLimits& import_limits) : limits(import_limits), budget(import_limits.memory_bytes) {}

  ImportLimits limits;
  GltfBudget budget;
  GltfNotes notes;
};

}  // namespace cyclorama::scene
