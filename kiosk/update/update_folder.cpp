// SPDX-License-Identifier: Apache-2.0
#include "kiosk/update/update_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "common/base/file.h"
#include "common/base/unique_fd.h"
#include "kiosk/update/update_signature.h"

namespace cyclorama::update {

namespace fs = std::filesystem;

Result<UpdateFolder> UpdateFolder::open(const fs::path& folder, const std::string& sums, const std::string& signature) {
  std::error_code failed;
  const auto before = read_text_file(folder / kUpdateSums, kMaxUpdateTextBytes);
  if (!before || *before != sums) fs::remove_all(folder, failed);
  if (!failed) fs::create_directories(folder, failed);
  if (failed) return Error(ErrorCode::kSystem, fmt::format("making '{}': {}", folder.string(), failed.message()));
  TRY(write_file_atomically(folder / kUpdateSignature, std::string_view(signature)));
  TRY(write_file_atomically(folder / kUpdateSums, std::string_view(sums)));
  return UpdateFolder(folder);
}

bool UpdateFolder::has(const UpdateFile& file) const {
  std::error_code failed;
  return fs::is_regular_file(fs::symlink_status(folder_ / file.name, failed));
}

std::uint64_t UpdateFolder::there(const UpdateFile& file, std::uint64_t bytes) const {
  std::error_code failed;
  const std::uint64_t size = fs::file_size(has(file) ? folder_ / file.name : part(file), failed);
  return failed || size > bytes ? 0 : size;
}

Result<std::uint64_t> UpdateFolder::room() const {
  std::error_code failed;
  const fs::space_info space = fs::space(folder_, failed);
  if (failed) return Error(ErrorCode::kSystem, fmt::format("looking at '{}': {}", folder_.string(), failed.message()));
  return space.available;
}

Status UpdateFolder::append(const UpdateFile& file, std::span<const std::byte> bytes) {
  const UniqueFd fd(::open(part(file).c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (!fd.is_open()) return Error::from_errno(fmt::format("writing '{}'", file.name));
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd.get(), bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return Error::from_errno(fmt::format("writing '{}'", file.name));
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return Done{};
}

Status UpdateFolder::finish(const UpdateFile& file) {
  const fs::path path = part(file);
  TRY_ASSIGN(const std::string found, sha256_of_file(path));
  if (found != file.sha256) {
    forget(file);
    return Error(ErrorCode::kBadData, fmt::format("'{}' is not the file that the signed {} names; it is fetched anew",
                                                  file.name, kUpdateSums));
  }
  const UniqueFd fd(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  if (!fd.is_open() || ::fsync(fd.get()) != 0 || ::rename(path.c_str(), (folder_ / file.name).c_str()) != 0) {
    return Error::from_errno(fmt::format("writing '{}'", file.name));
  }
  const UniqueFd folder(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open() || ::fsync(folder.get()) != 0) return Error::from_errno("writing an update's folder");
  return Done{};
}

void UpdateFolder::forget(const UpdateFile& file) {
  std::error_code ignored;
  fs::remove(part(file), ignored);
}

}  // namespace cyclorama::update
