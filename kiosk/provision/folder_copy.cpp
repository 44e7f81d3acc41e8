// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/folder_copy.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <set>

#include "common/base/text.h"
#include "common/base/unique_fd.h"
#include "common/wire/openssl.h"
#include "kiosk/provision/provisioning_report.h"

namespace cyclorama::provision {
namespace {

constexpr std::size_t kMaxNameLength = 80;
constexpr std::size_t kMaxEntries = 2000;
constexpr std::size_t kPartBytes = 64 * 1024;
constexpr std::size_t kHexDigits = 64;
constexpr std::array<std::string_view, 4> kNotOurs{"System Volume Information", "Thumbs.db", "desktop.ini",
                                                   "lost+found"};

using Digest = std::unique_ptr<EVP_MD_CTX, OpensslFree<EVP_MD_CTX_free>>;

Error refused(const std::string& name, std::string_view what_and_remedy) {
  return Error(ErrorCode::kInvalidArgument, fmt::format("'{}' {}", printable(name, 200), what_and_remedy));
}

Error cannot_write(const std::string& name) {
  const bool is_full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
  Error error = Error::from_errno(fmt::format("copying '{}'", name));
  return is_full ? Error(ErrorCode::kSystem, error.message() + "; there is no room for the new settings") : error;
}

std::string hex(const unsigned char* bytes, unsigned count) {
  std::string text;
  for (unsigned i = 0; i < count; ++i) text += fmt::format("{:02x}", bytes[i]);
  return text;
}

Digest new_digest() {
  Digest digest(EVP_MD_CTX_new());
  if (digest && EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr) != 1) digest.reset();
  return digest;
}

Result<std::string> finished(const Digest& digest) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned count = 0;
  if (!digest || EVP_DigestFinal_ex(digest.get(), bytes.data(), &count) != 1) {
    return Error(ErrorCode::kSystem, "OpenSSL cannot make a SHA-256");
  }
  return hex(bytes.data(), count);
}

/// Returns the names in an open folder, sorted.
Result<std::vector<std::string>> names_in(const UniqueFd& folder, const std::string& name) {
  const int copy = ::fcntl(folder.get(), F_DUPFD_CLOEXEC, 0);
  if (copy < 0) return Error::from_errno(fmt::format("reading the folder '{}'", name));
  const std::unique_ptr<DIR, int (*)(DIR*)> stream(::fdopendir(copy), ::closedir);
  if (!stream) {
    ::close(copy);
    return Error::from_errno(fmt::format("reading the folder '{}'", name));
  }
  std::vector<std::string> names;
  for (;;) {
    errno = 0;
    const dirent* const entry = ::readdir(stream.get());
    if (entry == nullptr && errno != 0) return Error::from_errno(fmt::format("reading the folder '{}'", name));
    if (entry == nullptr) break;
    const std::string_view one = entry->d_name;
    if (one == "." || one == "..") continue;
    if (names.size() >= kMaxEntries) return refused(name, "holds thousands of entries; it is no museum's settings");
    names.emplace_back(one);
  }
  std::sort(names.begin(), names.end());
  return names;
}

class Copier {
 public:
  Copier(const FolderLimits& limits, CopiedFolder* ret) : limits_(limits), copied_(*ret) {}

  Status copy_all(const UniqueFd& from, const UniqueFd& to, const std::string& within) {
    TRY_ASSIGN(const std::vector<std::string> names, names_in(from, within.empty() ? "." : within));
    for (const std::string& name : names) {
      const std::string path = within + name;
      if (name.starts_with('.') || std::find(kNotOurs.begin(), kNotOurs.end(), name) != kNotOurs.end()) {
        copied_.left_out.push_back(printable(path, 200));
        continue;
      }
      if (!is_plain_name(name)) {
        return refused(path, "has a name that is not plain; rename it with letters, digits, '.', '-' and '_' alone");
      }
      TRY(copy_entry(from, to, name, within));
    }
    if (::fsync(to.get()) != 0) return cannot_write(within.empty() ? "." : within);
    return Done{};
  }

 private:
  Status copy_entry(const UniqueFd& from, const UniqueFd& to, const std::string& name, const std::string& within) {
    const std::string path = within + name;
    // O_NONBLOCK: opening a pipe or a device must not block. The type is checked after opening, so that nobody can swap
    // the entry in between.
    const UniqueFd entry(::openat(from.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (!entry.is_open() && errno == ELOOP) return refused(path, "is a link; put the file itself there");
    if (!entry.is_open() && (errno == ENXIO || errno == ENODEV)) return refused(path, kNoFile);
    if (!entry.is_open()) return Error::from_errno(fmt::format("opening '{}'", path));
    struct stat info {};
    if (::fstat(entry.get(), &info) != 0) return Error::from_errno(fmt::format("reading '{}'", path));
    if (S_ISDIR(info.st_mode)) return copy_inner(entry, to, name, within);
    if (!S_ISREG(info.st_mode)) return refused(path, kNoFile);
    const auto bytes = static_cast<std::size_t>(info.st_size);
    if (bytes > limits_.max_file_bytes) {
      return refused(path, fmt::format("has {} MB; a file may have {}", bytes >> 20, limits_.max_file_bytes >> 20));
    }
    if (copied_.files.size() >= limits_.max_files) {
      return refused(path, fmt::format("is one file too many; there may be {}", limits_.max_files));
    }
    bytes_ += bytes;
    if (bytes_ > limits_.max_bytes) {
      return refused(path, fmt::format("is too much; all files may have {} MB together", limits_.max_bytes >> 20));
    }
    return copy_file(entry, bytes, to, name, path);
  }

  Status copy_inner(const UniqueFd& from, const UniqueFd& to, const std::string& name, const std::string& within) {
    if (!within.empty()) return refused(within + name, "is a folder in a folder; one level is enough");
    if (::mkdirat(to.get(), name.c_str(), 0700) != 0) return cannot_write(name);
    const UniqueFd inner(::openat(to.get(), name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (!inner.is_open()) return cannot_write(name);
    return copy_all(from, inner, name + "/");
  }

  Status copy_file(const UniqueFd& from, std::size_t bytes, const UniqueFd& to, const std::string& name,
                   const std::string& path) {
    const UniqueFd out(::openat(to.get(), name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
    if (!out.is_open()) return cannot_write(path);
    const Digest digest = new_digest();
    std::vector<char> part(kPartBytes);
    std::size_t done = 0;
    for (;;) {
      const ssize_t n = ::read(from.get(), part.data(), part.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) {
        return Error(ErrorCode::kBadData, Error::from_errno(fmt::format("reading '{}'", path)).message() +
                                              "; the stick is damaged, or was pulled out");
      }
      if (n == 0) break;
      const auto count = static_cast<std::size_t>(n);
      done += count;
      if (done > bytes) return refused(path, "grew while it was read; try again");
      if (digest) EVP_DigestUpdate(digest.get(), part.data(), count);
      TRY(write_all(out, part.data(), count, path));
    }
    if (done < bytes) {
      return Error(
          ErrorCode::kBadData,
          fmt::format("'{}' ends after {} of {} bytes; the stick is damaged, or was pulled out", path, done, bytes));
    }
    if (::fsync(out.get()) != 0) return cannot_write(path);
    TRY_ASSIGN(std::string sha256, finished(digest));
    copied_.files.push_back({path, bytes, std::move(sha256)});
    return Done{};
  }

  static Status write_all(const UniqueFd& out, const char* bytes, std::size_t count, const std::string& path) {
    for (std::size_t done = 0; done < count;) {
      const ssize_t n = ::write(out.get(), bytes + done, count - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return cannot_write(path);
      done += static_cast<std::size_t>(n);
    }
    return Done{};
  }

  static constexpr const char* kNoFile = "is neither a file nor a folder; take it away";
  const FolderLimits limits_;
  CopiedFolder& copied_;
  std::size_t bytes_ = 0;
};

Result<UniqueFd> open_folder(const std::filesystem::path& path) {
  UniqueFd fd(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (!fd.is_open()) return Error::from_errno(fmt::format("opening the folder '{}'", path.string()));
  return fd;
}

}  // namespace

bool is_plain_name(std::string_view name) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == '_';
  };
  return !name.empty() && name.size() <= kMaxNameLength && name.front() != '.' && name.front() != '-' &&
         std::all_of(name.begin(), name.end(), is_plain);
}

bool is_path_of_plain_names(std::string_view path) {
  const std::size_t slash = path.find('/');
  if (slash == std::string_view::npos) return is_plain_name(path);
  return is_plain_name(path.substr(0, slash)) && is_plain_name(path.substr(slash + 1));
}

FolderLimits within(std::uintmax_t available_bytes, FolderLimits limits) {
  constexpr std::uintmax_t kKeptFree = std::uintmax_t{256} << 20;
  constexpr std::uintmax_t kSettings = std::uintmax_t{1} << 20;
  const std::uintmax_t room = available_bytes > kKeptFree + kSettings ? available_bytes - kKeptFree : kSettings;
  limits.max_bytes = std::min<std::uintmax_t>(limits.max_bytes, room);
  return limits;
}

Result<CopiedFolder> copy_folder(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const FolderLimits& limits) {
  TRY_ASSIGN(const UniqueFd source, open_folder(from));
  TRY_ASSIGN(const UniqueFd target, open_folder(to));
  CopiedFolder copied;
  TRY(Copier(limits, &copied).copy_all(source, target, ""));
  std::sort(copied.files.begin(), copied.files.end(),
            [](const CopiedFile& a, const CopiedFile& b) { return a.name < b.name; });
  return copied;
}

Result<std::vector<CopiedFile>> parse_checksums(std::string_view text) {
  std::vector<CopiedFile> files;
  std::set<std::string, std::less<>> names;
  std::size_t line_number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    ++line_number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty()) continue;
    const auto bad = [&](std::string_view what) {
      return Error(ErrorCode::kBadData, fmt::format("line {}: {}; write the file with sha256sum", line_number, what));
    };
    // Two spaces, or a space and a '*' in binary mode.
    if (line.size() < kHexDigits + 3 || line[kHexDigits] != ' ' ||
        (line[kHexDigits + 1] != ' ' && line[kHexDigits + 1] != '*')) {
      return bad("not a SHA-256, two blanks and a name");
    }
    std::string_view name = line.substr(kHexDigits + 2);
    if (name.starts_with("./")) name.remove_prefix(2);
    if (!is_digest(line.substr(0, kHexDigits))) return bad("not 64 hexadecimal digits");
    if (!is_path_of_plain_names(name)) return bad("the name is not plain");
    if (!names.emplace(name).second) return bad(fmt::format("'{}' comes twice", name));
    if (files.size() >= FolderLimits{}.max_files) return bad("too many files");
    files.push_back({std::string(name), 0, std::string(line.substr(0, kHexDigits))});
  }
  return files;
}

std::string checksums_text(const std::vector<CopiedFile>& files) {
  std::string text;
  for (const CopiedFile& file : files) text += fmt::format("{}  {}\n", file.sha256, file.name);
  return text;
}

Result<std::string> sha256_of(std::string_view bytes) {
  const Digest digest = new_digest();
  if (digest) EVP_DigestUpdate(digest.get(), bytes.data(), bytes.size());
  return finished(digest);
}

}  // namespace cyclorama::provision
