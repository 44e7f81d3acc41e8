// SPDX-License-Identifier: Apache-2.0
/// A file in memory with given bytes, for readers that require a path.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "common/base/check.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// The file exists, and path() is valid, as long as this object exists.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : fd_(::memfd_create("memory_file", MFD_CLOEXEC)) {
    CHECK(fd_.is_open());
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t n = ::write(fd_.get(), bytes.data() + done, bytes.size() - done);
      CHECK(n > 0);
      done += static_cast<std::size_t>(n);
    }
  }
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(fd_.get()); }

 private:
  UniqueFd fd_;
};

}  // namespace cyclorama
