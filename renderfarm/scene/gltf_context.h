// SPDX-License-Identifier: Apache-2.0
/// What one glTF import carries through all of its parts: how much memory is left, and what the user is to be told.
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

namespace cyclorama {

/// Asked before memory is taken for anything whose size a file decides. Up to 4 GiB of the limit are there from the
/// start; the rest has to be earned by stored bytes, so that a small file cannot ask for a whole machine. Thread-bound.
class GltfBudget {
 public:
  explicit GltfBudget(std::size_t limit_bytes)
      : limit_bytes_(limit_bytes),
        left_bytes_(std::min(limit_bytes, kFreeBytes)),
        withheld_bytes_(limit_bytes - left_bytes_) {}

  /// The import reads `stored` bytes: it may take kBytesPerStored times as many.
  void earn(std::uint64_t stored);

  /// `place` needs `count` things of `bytes_each`. kBadData  that is more than what is left.
  Status take(std::string_view place, std::uint64_t count, std::size_t bytes_each);
  /// What was taken for a while is free again.
  void give_back(std::uint64_t count, std::size_t bytes_each) { left_bytes_ += count * bytes_each; }
  [[nodiscard]] std::size_t left_bytes() const { return left_bytes_; }

 private:
  static constexpr std::size_t kFreeBytes = std::size_t{4} << 30;
  static constexpr std::size_t kBytesPerStored = 64;  ///< Draco's triangles take about a byte each, and become 40.

  std::size_t limit_bytes_;
  std::size_t left_bytes_;
  std::size_t withheld_bytes_;
};

/// Model::notes in the making: the same sentence said of a thousand places is one note. Thread-bound.
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

}  // namespace cyclorama
