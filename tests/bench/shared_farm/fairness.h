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
  /// False for the case in which the tenth museum is like the others: what it adds to their p99 is the price of its
  /// share.
  [[nodiscard]] bool is_greedy() const;
  [[nodiscard]] double share_min() const;
  [[nodiscard]] double p99_ratio() const;  ///< The largest.
};

/// Simulates ten museums on 8 nodes of 4 threads for that time: nine of them, with a tenth like them, then with each
/// kind of greed whose name contains `only`.
[[nodiscard]] std::vector<FairnessCase> measure_fairness(double seconds, const std::string& only = "");

}  // namespace cyclorama
