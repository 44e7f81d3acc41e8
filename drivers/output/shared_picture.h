// SPDX-License-Identifier: Apache-2.0
/// What a head shows, published to other processes of the same machine as a mapped file in a run directory. This is how
/// the simulated room, and an operator's tool, see what the projectors shine.
///
/// File: a header, then two slots of RGB8 rows from the top. The writer fills the slot that was not published last, so
/// a reader nearly always copies an untouched slot; a sequence number tells when it did not, and it copies again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::output {

struct SharedPictureInfo {
  std::uint64_t picture = 0;  ///< Counts published pictures, from 1: unchanged means that nothing new was shown.
  std::uint64_t refresh = 0;  ///< Presented::refresh.
  TimePoint presented_at{};
};

/// <run_dir>/head-<head>.picture; bytes of `head` that do not belong into a file name are written as %XX.
[[nodiscard]] std::filesystem::path shared_picture_path(const std::filesystem::path& run_dir, std::string_view head);

/// Thread-bound; the readers may be anywhere. Never blocks on a reader.
class SharedPictureWriter {
 public:
  /// Replaces a file of that name; its readers then learn that their writer is gone. Makes no folders.
  /// kInvalidArgument  a side is not 1 to 16384 px.     kNotFound  no such folder.     kSystem  errno says why.
  static Result<SharedPictureWriter> create(const std::filesystem::path& path, int width, int height);
  SharedPictureWriter(SharedPictureWriter&&) noexcept;
  SharedPictureWriter& operator=(SharedPictureWriter&&) noexcept;
  ~SharedPictureWriter();

  /// Precondition: `picture` has the size given to create(). `info.picture` is ignored: the writer counts.
  void publish(const RgbImage& picture, const SharedPictureInfo& info);

 private:
  struct Mapping;
  explicit SharedPictureWriter(std::unique_ptr<Mapping> mapping);
  std::unique_ptr<Mapping> mapping_;
};

/// Thread-bound.
class SharedPictureReader {
 public:
  /// kNotFound  no writer has made it yet.   kBadData  not such a file, or of another version.   kSystem  errno says
  /// why.
  static Result<SharedPictureReader> open(const std::filesystem::path& path);
  SharedPictureReader(SharedPictureReader&&) noexcept;
  SharedPictureReader& operator=(SharedPictureReader&&) noexcept;
  ~SharedPictureReader();

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;

  /// Copies the newest whole picture into `*ret_picture`, which is made to fit and otherwise reused. Does not block.
  /// A writer that lives and publishes nothing holds its picture, as a projector does; `presented_at` tells its age.
  /// kUnavailable  the writer is gone (open again), or nothing was published yet.
  /// kBusy         the writer was faster than this reader several times over; try again.
  Result<SharedPictureInfo> read_newest(RgbImage* ret_picture);

 private:
  struct Mapping;
  explicit SharedPictureReader(std::unique_ptr<Mapping> mapping);
  std::unique_ptr<Mapping> mapping_;
};

}  // namespace cyclorama::output
