// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/kernel_file.h"

#include <cstdio>

namespace cyclorama::operations {

std::optional<std::string> read_kernel_file(const std::filesystem::path& path) {
  constexpr std::size_t kMaxBytes = std::size_t{64} * 1024;
  std::FILE* const file = std::fopen(path.c_str(), "re");
  if (file == nullptr) return std::nullopt;
  std::string text(kMaxBytes, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file));
  std::fclose(file);
  return text;
}

}  // namespace cyclorama::operations
