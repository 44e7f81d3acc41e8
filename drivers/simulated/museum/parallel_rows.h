// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <thread>
#include <vector>

namespace cyclorama::simulated {

/// Calls work(begin, end) for consecutive ranges that cover [0, rows) on `threads` threads, and waits for all of them.
/// The ranges must write to disjoint memory.
template <typename Work>
void for_rows(int rows, int threads, const Work& work) {
  std::vector<std::jthread> others;
  for (int i = 1; i < threads; ++i)
    others.emplace_back([&work, rows, i, threads] { work(rows * i / threads, rows * (i + 1) / threads); });
  work(0, threads > 0 ? rows / threads : rows);
}

}  // namespace cyclorama::simulated
