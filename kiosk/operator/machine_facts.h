// SPDX-License-Identifier: Apache-2.0
/// What this computer tells about itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace cyclorama {

/// A value; what could not be learnt is absent.
struct MachineFacts {
  std::optional<std::uint64_t> disk_free_bytes{};  ///< Where the museum keeps its state.
  std::optional<std::uint64_t> disk_bytes{};
  std::optional<bool> is_read_only{};  ///< That disk, which a kernel makes so after an error.
  std::optional<double> warmest_c{};   ///< Of all thermal zones.
  std::optional<double> critical_c{};  ///< Where that zone switches the computer off.
  std::optional<bool> is_clock_set{};  ///< By a time server, since the start.
  std::optional<double> memory_free_share{};
  std::string only_in_memory{};      ///< Why the image keeps its state in memory alone; empty: it does not.
  std::uint64_t slowed_by_heat = 0;  ///< Times since the start, of the processor.
};

/// `state` lies on the disk that is looked at; `root` is "/" but in tests. Reads a few small files.
[[nodiscard]] MachineFacts read_machine_facts(const std::filesystem::path& state,
                                              const std::filesystem::path& root = "/");

}  // namespace cyclorama
