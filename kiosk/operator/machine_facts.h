// SPDX-License-Identifier: Apache-2.0
/// Facts about this computer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace cyclorama::operations {

/// Firmware's check of what it starts. In setup mode it has no keys yet and checks nothing.
enum class SecureBoot { kUnknown, kOn, kSetupMode, kOff };

/// A value; unknown facts are absent.
struct MachineFacts {
  std::optional<std::uint64_t> disk_free_bytes{};  ///< Free space on the disk that holds the museum's state.
  std::optional<std::uint64_t> disk_bytes{};
  std::optional<bool> is_read_only{};  ///< True if that disk is read-only, as the kernel makes it after an error.
  std::optional<double> warmest_c{};   ///< Maximum of all thermal zones.
  std::optional<double> critical_c{};  ///< Temperature at which that zone switches the computer off.
  std::optional<bool> is_clock_set{};  ///< True once a time server has set the clock.
  std::optional<double> memory_free_share{};
  std::string only_in_memory{};      ///< Reason why the image keeps its state in memory only; empty: it does not.
  std::uint64_t slowed_by_heat = 0;  ///< Number of times since the start that heat slowed the processor.
  SecureBoot secure_boot = SecureBoot::kUnknown;  ///< The state that the image found at its start.
  bool is_encrypted = false;                      ///< True if the image encrypts its state.
  std::string unencrypted{};                      ///< Reason why the image does not encrypt it; empty: no reason known.
};

/// `state` lies on the disk to examine; `root` is "/" except in tests. Reads a few small files.
[[nodiscard]] MachineFacts read_machine_facts(const std::filesystem::path& state,
                                              const std::filesystem::path& root = "/");

}  // namespace cyclorama::operations
