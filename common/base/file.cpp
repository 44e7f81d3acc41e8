// SPDX-License-Identifier: Apache-2.0
#include "common/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cerrno>
#include <utility>

namespace cyclorama {
namespace {

struct OpenFile {
  UniqueFd fd;
  std::size_t size = 0;
};

Result<OpenFile> open_regular(const std::filesystem::path& path) {
  OpenFile file;
  // O_NONBLOCK: a named pipe in place of a file must not block this process. It has no effect on regular files.
  file.fd = UniqueFd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.fd.is_open()) return Error::from_errno(fmt::format("opening '{}'", path.string()));
  struct stat info {};
  if (::fstat(file.fd.get(), &info) != 0) return Error::from_errno(fmt::format("reading '{}'", path.string()));
  if (!S_ISREG(info.st_mode)) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' is not a regular file", path.string()));
  }
  file.size = static_cast<std::size_t>(info.st_size);
  return file;
}

template <typename Container>
Result<Container> read_into(const std::filesystem::path& path, std::size_t limit_bytes) {
  TRY_ASSIGN(const OpenFile file, open_regular(path));
  if (file.size > limit_bytes) {
    return Error(ErrorCode::kBadData,
                 fmt::format("'{}' has {} bytes; at most {} are accepted here", path.string(), file.size, limit_bytes));
  }
  Container content;
  content.resize(file.size);
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t n = ::read(file.fd.get(), content.data() + done, content.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return Error::from_errno(fmt::format("reading '{}'", path.string()));
    if (n == 0) break;  // The file was truncated meanwhile; what remains is returned.
    done += static_cast<std::size_t>(n);
  }
  content.resize(done);
  return content;
}

}  // namespace

Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::size_t limit_bytes) {
  return read_into<std::vector<std::byte>>(path, limit_bytes);
}

Result<std::string> read_text_file(const std::filesystem::path& path, std::size_t limit_bytes) {
  return read_into<std::string>(path, limit_bytes);
}

Status write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::string temporary = path.string() + ".XXXXXX";
  const UniqueFd fd(::mkostemp(temporary.data(), O_CLOEXEC));
  if (!fd.is_open()) return Error::from_errno(fmt::format("creating '{}'", path.string()));
  const auto give_up = [&](const char* doing) {
    Error error = Error::from_errno(fmt::format("{} '{}'", doing, path.string()));
    ::unlink(temporary.c_str());
    return error;
  };
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(fd.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return give_up("writing");
    done += static_cast<std::size_t>(n);
  }
  if (::fchmod(fd.get(), 0644) != 0 || ::fdatasync(fd.get()) != 0) return give_up("writing");
  if (::rename(temporary.c_str(), path.c_str()) != 0) return give_up("renaming to");
  return Done{};
}

Status write_file_atomically(const std::filesystem::path& path, std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text)));
}

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  TRY_ASSIGN(const OpenFile file, open_regular(path));
  if (file.size == 0) return MappedFile({});
  void* const address = ::mmap(nullptr, file.size, PROT_READ, MAP_PRIVATE, file.fd.get(), 0);
  if (address == MAP_FAILED) return Error::from_errno(fmt::format("mapping '{}'", path.string()));
  return MappedFile({static_cast<const std::byte*>(address), file.size});
}

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

}  // namespace cyclorama
