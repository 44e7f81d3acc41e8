// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/file_beside.h"

#include <algorithm>

namespace cyclorama::scene {

std::filesystem::path file_beside(const std::filesystem::path& folder, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const std::filesystem::path file = std::filesystem::path(name).lexically_normal();
  const bool leads_out =
      file.is_absolute() || file.empty() || *file.begin() == ".." || name.find(':') != std::string::npos;
  return folder / (leads_out ? file.filename() : file);
}

}  // namespace cyclorama::scene
