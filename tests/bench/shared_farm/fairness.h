// SPDX-License-Identifier: Apache-2.0
/// The shares that nine honest museums keep beside a tenth that takes all that it can get.
#pragma once

#include <string>
#include <vector>

namespace cyclorama {

/// An honest museum, beside a greedy one and without it.
struct HonestMuseum {
  std::string name{};
  double share = 0.0;      ///< Served part of what it requested, which is less than its fair share of the farm.
  double p99_ms = 0.0;     ///< The 99th percentile of its frame times.
  double p99_ratio = 0.0;  ///< Over its p99 without the greedy museum.
};

/// One kind of greed.
struct FairnessCase {
  std::string greed{};
  std::vector<HonestMuseum> honest{};
  double utilisation = 0.0;
  double coordinator_ms_per_frame = 0.0;
  [[nodiscard]] double share_min() const;
  [[nodiscard]] double p99_ratio() const;  ///< The largest.
};

/// Simulates ten museums on 8 nodes of 4 threads for that time: once without greed, then with each kind.
[[nodiscard]] std::vector<FairnessCase> measure_fairness(double seconds);

}  // namespace cyclorama
