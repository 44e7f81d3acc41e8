// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/shared_picture.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <span>
#include <utility>

#include "common/base/unique_fd.h"

namespace cyclorama::output {
namespace {

constexpr std::uint64_t kMagic = 0x3154434950435943;  // "CYCPICT1" in a little-endian file.
constexpr std::uint32_t kVersion = 1;
constexpr int kMaxSidePx = 16384;
constexpr int kSlots = 2;
constexpr int kMaxAttempts = 8;

using Word = std::atomic<std::uint64_t>;
static_assert(Word::is_always_lock_free && sizeof(Word) == 8, "an atomic must work between processes");

struct Slot {
  Word refresh;
  std::atomic<std::int64_t> presented_at_ns;
};

// Memory order (H. Boehm, "Can seqlocks get along with programming language memory models?", 2012), without fences,
// which ThreadSanitizer does not support: every word of a slot is stored with release and loaded with acquire. A reader
// that reads a word of picture n + 2 in the slot of picture n therefore sees `started` >= n + 2 afterwards and retries.
struct Header {
  std::uint64_t magic;
  std::uint32_t version;
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t reserved;
  Word started;    // Newest picture whose writing has begun.
  Word published;  // Newest complete picture; 0 for none. Picture n is in slot n % kSlots.
  Slot slots[kSlots];
};

std::size_t slot_words(int width, int height) {
  return (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * RgbImage::kChannels + 7) / 8;
}
std::size_t file_bytes(int width, int height) { return sizeof(Header) + kSlots * 8 * slot_words(width, height); }

/// Owns a shared mapping and its file, whose lock shows that the writer is alive.
struct PictureFile {
  UniqueFd fd;
  Header* header = nullptr;
  std::size_t bytes = 0;
  int width = 0;
  int height = 0;

  PictureFile() = default;
  PictureFile(const PictureFile&) = delete;
  PictureFile& operator=(const PictureFile&) = delete;
  ~PictureFile() {
    if (header != nullptr) ::munmap(header, bytes);
  }
  Status map(int protection, const std::filesystem::path& path) {
    void* const address = ::mmap(nullptr, bytes, protection, MAP_SHARED, fd.get(), 0);
    if (address == MAP_FAILED) return Error::from_errno(fmt::format("mapping '{}'", path.string()));
    header = static_cast<Header*>(address);
    return Done{};
  }
  [[nodiscard]] Word* pixels_of(std::uint64_t picture) const {
    return reinterpret_cast<Word*>(header + 1) + picture % kSlots * slot_words(width, height);
  }
  [[nodiscard]] Slot& slot_of(std::uint64_t picture) const { return header->slots[picture % kSlots]; }
};

void store_words(std::span<const std::uint8_t> from, Word* to) {
  std::size_t i = 0;
  for (; i + 8 <= from.size(); i += 8, ++to) {
    std::uint64_t word = 0;
    std::memcpy(&word, from.data() + i, 8);
    to->store(word, std::memory_order_release);
  }
  if (i < from.size()) {
    std::uint64_t word = 0;
    std::memcpy(&word, from.data() + i, from.size() - i);
    to->store(word, std::memory_order_release);
  }
}

void load_words(const Word* from, std::span<std::uint8_t> to) {
  std::size_t i = 0;
  for (; i + 8 <= to.size(); i += 8, ++from) {
    const std::uint64_t word = from->load(std::memory_order_acquire);
    std::memcpy(to.data() + i, &word, 8);
  }
  if (i < to.size()) {
    const std::uint64_t word = from->load(std::memory_order_acquire);
    std::memcpy(to.data() + i, &word, to.size() - i);
  }
}

}  // namespace

std::filesystem::path shared_picture_path(const std::filesystem::path& run_dir, std::string_view head) {
  std::string name;
  for (const char c : head) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    name += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return run_dir / ("head-" + name + ".picture");
}

struct SharedPictureWriter::Mapping : PictureFile {};
struct SharedPictureReader::Mapping : PictureFile {};

Result<SharedPictureWriter> SharedPictureWriter::create(const std::filesystem::path& path, int width, int height) {
  if (width < 1 || height < 1 || width > kMaxSidePx || height > kMaxSidePx) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("a head of {}x{} pixels cannot be shared", width, height));
  }
  auto mapping = std::make_unique<Mapping>();
  mapping->width = width;
  mapping->height = height;
  mapping->bytes = file_bytes(width, height);
  std::string temporary = path.string() + ".XXXXXX";
  mapping->fd = UniqueFd(::mkostemp(temporary.data(), O_CLOEXEC));
  if (!mapping->fd.is_open()) return Error::from_errno(fmt::format("creating '{}'", path.string()));
  const auto prepare = [&]() -> Status {
    const int fd = mapping->fd.get();
    // Allocated now, so that a full disk causes an error here and not SIGBUS later. The lock is released when the
    // process ends.
    const int refused = ::posix_fallocate(fd, 0, static_cast<off_t>(mapping->bytes));
    if (refused != 0) errno = refused;
    if (refused != 0 || ::fchmod(fd, 0644) != 0 || ::flock(fd, LOCK_EX | LOCK_NB) != 0) {
      return Error::from_errno(fmt::format("creating '{}'", path.string()));
    }
    TRY(mapping->map(PROT_READ | PROT_WRITE, path));
    Header& header = *mapping->header;
    header.magic = kMagic;
    header.version = kVersion;
    header.width = static_cast<std::uint32_t>(width);
    header.height = static_cast<std::uint32_t>(height);
    if (::rename(temporary.c_str(), path.c_str()) != 0) {
      return Error::from_errno(fmt::format("renaming to '{}'", path.string()));
    }
    return Done{};
  };
  if (Status status = prepare(); !status) {
    ::unlink(temporary.c_str());
    return std::move(status).error();
  }
  return SharedPictureWriter(std::move(mapping));
}

SharedPictureWriter::SharedPictureWriter(std::unique_ptr<Mapping> mapping) : mapping_(std::move(mapping)) {}
SharedPictureWriter::SharedPictureWriter(SharedPictureWriter&&) noexcept = default;
SharedPictureWriter& SharedPictureWriter::operator=(SharedPictureWriter&&) noexcept = default;
SharedPictureWriter::~SharedPictureWriter() = default;

void SharedPictureWriter::publish(const RgbImage& picture, const SharedPictureInfo& info) {
  CHECK(picture.width() == mapping_->width && picture.height() == mapping_->height);
  Header& header = *mapping_->header;
  const std::uint64_t number = header.published.load(std::memory_order_relaxed) + 1;
  header.started.store(number, std::memory_order_relaxed);
  Slot& slot = mapping_->slot_of(number);
  slot.refresh.store(info.refresh, std::memory_order_release);
  slot.presented_at_ns.store(to_nanoseconds(info.presented_at), std::memory_order_release);
  store_words(picture.data(), mapping_->pixels_of(number));
  header.published.store(number, std::memory_order_release);
}

Result<SharedPictureReader> SharedPictureReader::open(const std::filesystem::path& path) {
  auto mapping = std::make_unique<Mapping>();
  mapping->fd = UniqueFd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!mapping->fd.is_open()) return Error::from_errno(fmt::format("opening '{}'", path.string()));
  struct stat info {};
  if (::fstat(mapping->fd.get(), &info) != 0) return Error::from_errno(fmt::format("reading '{}'", path.string()));
  const Error not_ours(ErrorCode::kBadData,
                       fmt::format("'{}' is not a picture of this version's display", path.string()));
  if (!S_ISREG(info.st_mode) || info.st_size < static_cast<off_t>(sizeof(Header))) return not_ours;
  mapping->bytes = static_cast<std::size_t>(info.st_size);
  TRY(mapping->map(PROT_READ, path));
  const Header& header = *mapping->header;
  if (header.magic != kMagic || header.version != kVersion || header.width < 1 || header.height < 1 ||
      header.width > kMaxSidePx || header.height > kMaxSidePx) {
    return not_ours;
  }
  mapping->width = static_cast<int>(header.width);
  mapping->height = static_cast<int>(header.height);
  if (mapping->bytes != file_bytes(mapping->width, mapping->height)) return not_ours;
  return SharedPictureReader(std::move(mapping));
}

SharedPictureReader::SharedPictureReader(std::unique_ptr<Mapping> mapping) : mapping_(std::move(mapping)) {}
SharedPictureReader::SharedPictureReader(SharedPictureReader&&) noexcept = default;
SharedPictureReader& SharedPictureReader::operator=(SharedPictureReader&&) noexcept = default;
SharedPictureReader::~SharedPictureReader() = default;

int SharedPictureReader::width() const { return mapping_->width; }
int SharedPictureReader::height() const { return mapping_->height; }

Result<SharedPictureInfo> SharedPictureReader::read_newest(RgbImage* ret_picture) {
  // A shared lock can be acquired only if no writer holds its exclusive lock.
  if (::flock(mapping_->fd.get(), LOCK_SH | LOCK_NB) == 0) {
    ::flock(mapping_->fd.get(), LOCK_UN);
    return Error(ErrorCode::kUnavailable, "the display that made this picture is gone");
  }
  if (ret_picture->width() != width() || ret_picture->height() != height()) *ret_picture = RgbImage(width(), height());
  const Header& header = *mapping_->header;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    SharedPictureInfo info;
    info.picture = header.published.load(std::memory_order_acquire);
    if (info.picture == 0) return Error(ErrorCode::kUnavailable, "the display has shown no picture yet");
    const Slot& slot = mapping_->slot_of(info.picture);
    info.refresh = slot.refresh.load(std::memory_order_acquire);
    info.presented_at = from_nanoseconds(slot.presented_at_ns.load(std::memory_order_acquire));
    load_words(mapping_->pixels_of(info.picture), ret_picture->data());
    if (header.started.load(std::memory_order_relaxed) < info.picture + kSlots) return info;
  }
  return Error(ErrorCode::kBusy, "the display publishes pictures faster than they can be read");
}

}  // namespace cyclorama::output
