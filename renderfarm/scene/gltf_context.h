// SPDX-License-Identifier: Apache-2.0
/// What one glTF import carries through all of its parts: how much memory is left, and what the user is to be told.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Asked before memory is taken for anything whose size a file decides. Thread-bound.
class GltfBudget {
 public:
  explicit GltfBudget(std::size_t limit_bytes) : limit_bytes_(limit_bytes), left_bytes_(limit_bytes) {}

  /// `place` needs `count` things of `bytes_each`. kBadData  that is more than what is left.
  Status take(std::string_view place, std::uint64_t count, std::size_t bytes_each);
  /// What was taken for a while is free again.
  void give_back(std::uint64_t count, std::size_t bytes_each) { left_bytes_ += count * bytes_each; }
  [[nodiscard]] std::size_t left_bytes() const { return left_bytes_; }

 private:
  std::size_t limit_bytes_;
  std::size_t left_bytes_;
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
