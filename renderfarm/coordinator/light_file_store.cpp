// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/light_file_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "common/base/text.h"

namespace cyclorama::coordinator {
namespace {

constexpr std::size_t kMaxFiles = 64;  ///< Far more than the number of scenes that nodes load at a time.

Error full(const std::string& doing) {
  const Error reason = Error::from_errno(doing);
  return Error(ErrorCode::kBusy, reason.message());
}

}  // namespace

void LightFileStore::accept(const wire::LightVersion& light) {
  const std::lock_guard lock(mutex_);
  const auto known = [&](const Entry& entry) { return entry.light.version() == light.version(); };
  if (std::ranges::any_of(entries_, known)) return;
  entries_.push_front({light});
  if (entries_.size() > kMaxFiles) entries_.pop_back();
}

Result<std::unique_ptr<LightFileStore::Receipt>> LightFileStore::receive(const std::string& version) {
  wire::LightVersion light;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(entries_, version, [](const Entry& entry) { return entry.light.version(); });
    if (found == entries_.end()) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("nobody requested light of version '{}'", printable(version)));
    }
    light = found->light;
  }
  std::error_code none;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(none);
  UniqueFd file(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (file.get() < 0) return full(fmt::format("making a file in '{}'", folder.string()));
  return std::unique_ptr<Receipt>(new Receipt(*this, std::move(light), std::move(file)));
}

Status LightFileStore::Receipt::add(std::span<const std::byte> bytes) {
  if (bytes.size() > light_.bytes() - bytes_) {
    return Error(ErrorCode::kBusy, fmt::format("the light is larger than the announced {} bytes", light_.bytes()));
  }
  sum_.add(bytes);
  bytes_ += bytes.size();
  while (!bytes.empty()) {
    const ssize_t n = ::write(file_.get(), bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return full("writing light that a node sends");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return Done{};
}

Status LightFileStore::Receipt::finish() {
  if (bytes_ != light_.bytes() || sum_.hexadecimal() != light_.version()) {
    return Error(ErrorCode::kInvalidArgument, "the bytes are not those of the light's version");
  }
  store_.keep(light_.version(), std::move(file_));
  return Done{};
}

void LightFileStore::keep(const std::string& version, UniqueFd file) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(entries_, version, [](const Entry& entry) { return entry.light.version(); });
  if (found != entries_.end()) found->file = std::move(file);
}

Result<scene_distribution::StampedFile> LightFileStore::open(const std::string& version) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(entries_, version, [](const Entry& entry) { return entry.light.version(); });
  if (found == entries_.end() || found->file.get() < 0) {
    return Error(ErrorCode::kNotFound, "the farm has no file of such light (any more)");
  }
  scene_distribution::StampedFile file;
  file.fd = UniqueFd(::fcntl(found->file.get(), F_DUPFD_CLOEXEC, 0));
  if (file.fd.get() < 0) return Error::from_errno("opening light once more");
  file.stamp.bytes = found->light.bytes();
  return file;
}

}  // namespace cyclorama::coordinator
