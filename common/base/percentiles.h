// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cyclorama {

/// Percentiles of the last `window` samples of one quantity. Uses a fixed amount of memory. Thread-bound.
class Percentiles {
 public:
  explicit Percentiles(std::size_t window = 4096);

  /// Adds a sample; NaN is not a measurement and is ignored.
  void add(double sample);

  [[nodiscard]] std::uint64_t count() const { return count_; }  ///< Number of samples ever added.
  [[nodiscard]] double mean() const;                            ///< Mean of the window; 0 if it is empty.
  /// Returns the percentile by nearest rank, for a `fraction` in [0, 1]; 0 if the window is empty.
  [[nodiscard]] double at(double fraction) const;

 private:
  std::size_t window_;
  std::size_t next_ = 0;
  std::uint64_t count_ = 0;
  std::vector<double> samples_;
};

}  // namespace cyclorama
