// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cyclorama {

/// The last `window` samples of one quantity, and what they look like sorted. Memory is fixed. Thread-bound.
class Percentiles {
 public:
  explicit Percentiles(std::size_t window = 4096);

  /// A NaN is not a measurement and is ignored.
  void add(double sample);

  [[nodiscard]] std::uint64_t count() const { return count_; }  ///< All samples ever added.
  [[nodiscard]] double mean() const;                            ///< Of the window; 0 when empty.
  /// Nearest rank, `fraction` in [0, 1]; 0 when empty.
  [[nodiscard]] double at(double fraction) const;

 private:
  std::size_t window_;
  std::size_t next_ = 0;
  std::uint64_t count_ = 0;
  std::vector<double> samples_;
};

}  // namespace cyclorama
