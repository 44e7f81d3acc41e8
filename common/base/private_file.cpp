// SPDX-License-Identifier: Apache-2.0
#include "common/base/private_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "common/base/unique_fd.h"

namespace cyclorama {

Status write_private_file(const std::filesystem::path& path, std::string_view text) {
  const std::filesystem::path temporary = path.string() + ".new";
  ::unlink(temporary.c_str());
  const UniqueFd fd(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!fd.is_open() || ::write(fd.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      ::fsync(fd.get()) != 0 || ::rename(temporary.c_str(), path.c_str()) != 0) {
    return Error::from_errno(fmt::format("writing '{}'", path.string()));
  }
  return Done{};
}

}  // namespace cyclorama
