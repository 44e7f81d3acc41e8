// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/zip_archive.h"

#include <sys/stat.h>
#include <zip.h>

#include <algorithm>
#include <set>

#include "appliance/interchange/fault.h"
#include "common/base/text.h"

namespace cyclorama::interchange {
namespace {

constexpr zip_int64_t kMaxMembers = 1024;
constexpr std::size_t kMaxNameLength = 512;
constexpr std::uint64_t kMaxExpansion = 1032;  ///< Maximum expansion of deflate. Source: zlib, "Technical Details".
constexpr std::uint64_t kSlackBytes = 1024;
constexpr int kQuick = 1;  ///< Fast, since measured maps hardly shrink at any level.
constexpr zip_uint16_t kNewYear1980 = 1 << 5 | 1;
constexpr zip_uint32_t kUnixKind = S_IFMT;

/// Owns a zip_error_t, and with it the error's text.
class ZipFault {
 public:
  ZipFault() { zip_error_init(&error_); }
  ~ZipFault() { zip_error_fini(&error_); }
  ZipFault(const ZipFault&) = delete;
  ZipFault& operator=(const ZipFault&) = delete;
  zip_error_t* get() { return &error_; }
  [[nodiscard]] const char* text() { return zip_error_strerror(&error_); }

 private:
  zip_error_t error_{};
};

std::string place_of(std::string_view member) { return fmt::format("member '{}'", printable(member)); }

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

Status check_name(std::string_view name) {
  const auto bad = [&](std::string_view what) {
    return fault(place_of(name), what, "pack the archive again with plain file names");
  };
  if (name.empty() || name.size() > kMaxNameLength) return bad("its name is empty or too long");
  if (name.front() == '/' || (name.size() > 1 && name[1] == ':')) return bad("its name is absolute");
  if (name.find('\\') != std::string_view::npos) return bad("its name has a backslash");
  if (printable(name, kMaxNameLength) != name) return bad("its name is no plain text");
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    if (name.substr(at, end - at) == "..") return bad("its name leaves the archive");
    at = end + 1;
  }
  return Done{};
}

/// Checks a member's directory entry before anything is unpacked.
Status check_member(zip_t* archive, zip_uint64_t index, const zip_stat_t& about) {
  const std::string location = place_of(about.name);
  TRY(check_name(about.name));
  zip_uint8_t system = 0;
  zip_uint32_t attributes = 0;
  if (zip_file_get_external_attributes(archive, index, 0, &system, &attributes) == 0 && system == ZIP_OPSYS_UNIX &&
      ((attributes >> 16) & kUnixKind) == S_IFLNK) {
    return fault(location, "it is a link", "pack the file itself");
  }
  if ((about.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && about.encryption_method != ZIP_EM_NONE) {
    return fault(location, "it is encrypted", "pack it without a password");
  }
  if (about.comp_method != ZIP_CM_STORE && about.comp_method != ZIP_CM_DEFLATE) {
    return fault(location, fmt::format("it is packed by method {}", about.comp_method), "pack it with deflate");
  }
  if (about.size / kMaxExpansion > about.comp_size + kSlackBytes) {
    return fault(location, fmt::format("{} bytes claim to unpack to {}", about.comp_size, about.size),
                 "do not use this file: its sizes are not true");
  }
  return Done{};
}

}  // namespace

void ZipReader::Discard::operator()(zip* archive) const { zip_discard(archive); }

Result<ZipReader> ZipReader::open(std::span<const std::byte> archive, std::size_t limit_bytes) {
  ZipFault error;
  zip_source_t* const source = zip_source_buffer_create(archive.data(), archive.size(), 0, error.get());
  CHECK(source != nullptr);
  ZipReader reader;
  reader.archive_.reset(zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, error.get()));
  if (reader.archive_ == nullptr) {
    zip_source_free(source);
    return fault("zip directory", error.text(), "copy or export the file again");
  }
  const zip_int64_t count = zip_get_num_entries(reader.archive_.get(), 0);
  if (count > kMaxMembers) {
    return fault("zip directory", fmt::format("it has {} members, and at most {} are accepted", count, kMaxMembers),
                 "pack only what mpcdi.xml names");
  }
  std::set<std::string> seen;
  for (zip_uint64_t i = 0; i < static_cast<zip_uint64_t>(count); ++i) {
    zip_stat_t about{};
    if (zip_stat_index(reader.archive_.get(), i, 0, &about) != 0 || about.name == nullptr) {
      return fault("zip directory", fmt::format("member {} cannot be read", i), "copy or export the file again");
    }
    TRY(check_member(reader.archive_.get(), i, about));
    if (!seen.insert(in_lower_case(about.name)).second) {
      return fault(place_of(about.name), "its name is there twice", "pack the archive again");
    }
    reader.names_.emplace_back(about.name);
  }
  reader.left_bytes_ = limit_bytes;
  return reader;
}

Result<std::vector<std::byte>> ZipReader::read(const std::string& name) {
  const std::string location = place_of(name);
  zip_stat_t about{};
  if (zip_stat(archive_.get(), name.c_str(), 0, &about) != 0) {
    return fault(location, "the archive has no such member", "pack it too, or correct the path");
  }
  if (about.size > left_bytes_) {
    return fault(location,
                 fmt::format("it unpacks to {} bytes, and {} are left of what is accepted", about.size, left_bytes_),
                 "split the file, or export smaller maps");
  }
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(zip_fopen_index(archive_.get(), about.index, 0),
                                                               zip_fclose);
  if (file == nullptr) return fault(location, zip_strerror(archive_.get()), "copy or export the file again");
  std::vector<std::byte> bytes(about.size);
  for (std::size_t done = 0; done < bytes.size();) {
    const zip_int64_t n = zip_fread(file.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0) return fault(location, zip_file_strerror(file.get()), "copy or export the file again");
    if (n == 0) {
      return fault(location, fmt::format("it ends after {} of {} bytes", done, bytes.size()),
                   "copy or export the file again");
    }
    done += static_cast<std::size_t>(n);
  }
  std::byte more{};
  if (const zip_int64_t n = zip_fread(file.get(), &more, 1); n != 0) {  // Reading to the end verifies the checksum.
    return fault(location, n > 0 ? "it is longer than it says" : zip_file_strerror(file.get()),
                 "copy or export the file again");
  }
  left_bytes_ -= bytes.size();
  return bytes;
}

Result<std::vector<std::byte>> write_zip(std::span<const ZipMember> members) {
  ZipFault error;
  zip_source_t* const target = zip_source_buffer_create(nullptr, 0, 0, error.get());
  CHECK(target != nullptr);
  zip_source_keep(target);
  const std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> kept(target, zip_source_free);
  const auto failed = [](const char* text) {
    return Error(ErrorCode::kSystem, fmt::format("packing a zip archive: {}", text));
  };
  zip_t* archive = zip_open_from_source(target, ZIP_TRUNCATE, error.get());
  if (archive == nullptr) {
    zip_source_free(target);
    return failed(error.text());
  }
  for (const ZipMember& member : members) {
    zip_source_t* const source = zip_source_buffer(archive, member.bytes.data(), member.bytes.size(), 0);
    CHECK(source != nullptr);
    const zip_int64_t index = zip_file_add(archive, member.name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      const Error e = failed(zip_strerror(archive));
      zip_discard(archive);
      return e;
    }
    const auto at = static_cast<zip_uint64_t>(index);
    CHECK(zip_set_file_compression(archive, at, ZIP_CM_DEFLATE, kQuick) == 0);
    CHECK(zip_file_set_dostime(archive, at, 0, kNewYear1980, 0) == 0);
  }
  if (zip_close(archive) != 0) {
    const Error e = failed(zip_strerror(archive));
    zip_discard(archive);
    return e;
  }
  zip_stat_t about{};
  if (zip_source_stat(target, &about) != 0 || zip_source_open(target) != 0) return failed("it cannot be read back");
  std::vector<std::byte> bytes(about.size);
  const zip_int64_t n = zip_source_read(target, bytes.data(), bytes.size());
  zip_source_close(target);
  if (n < 0 || static_cast<std::size_t>(n) != bytes.size()) return failed("it cannot be read back");
  return bytes;
}

}  // namespace cyclorama::interchange
