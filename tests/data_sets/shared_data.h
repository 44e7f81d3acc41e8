// SPDX-License-Identifier: Apache-2.0
/// Real test data that the repository may not contain. Tests that need it are skipped where it is absent.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace cyclorama {

/// Returns the file or folder `name` below shared/data, such as "apriltag/wpilib/short.mp4"; nothing if it is absent.
inline std::optional<std::filesystem::path> shared_data(const std::string& name) {
  const char* const root = std::getenv("CYCLORAMA_SHARED");
  if (root == nullptr) return std::nullopt;
  std::filesystem::path path = std::filesystem::path(root) / "data" / name;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  return path;
}

}  // namespace cyclorama

/// Declares the path `variable`, or skips this test; fails it if CYCLORAMA_REQUIRE_SHARED=1 requires the data.
#define CYCLORAMA_SHARED_DATA(variable, name)                                                \
  const auto variable##_or_nothing = ::cyclorama::shared_data(name);                         \
  if (!variable##_or_nothing) {                                                              \
    const char* const required = std::getenv("CYCLORAMA_REQUIRE_SHARED");                    \
    if (required != nullptr && std::string(required) == "1") FAIL() << name << " is absent"; \
    GTEST_SKIP() << name << " is absent: this test needs the shared test data";              \
  }                                                                                          \
  /* NOLINTNEXTLINE(bugprone-macro-parentheses): it is declared here. */                     \
  const std::filesystem::path& variable = *variable##_or_nothing
