// SPDX-License-Identifier: Apache-2.0
/// Publishes a head's picture to other processes of the same machine as a mapped file in a run directory. The simulated
/// room and an operator's tool use it to see what the projectors show.
///
/// File: a header, then two slots of RGB8 rows from the top. The writer fills the slot that was not published last, so
/// that a reader almost always copies a slot that does not change meanwhile; if it does change, a sequence number shows
/// it, and the reader copies again.
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
  std::uint64_t picture = 0;  ///< Number of the picture, from 1; unchanged if nothing new was shown.
  std::uint64_t refresh = 0;  ///< Presented::refresh.
  TimePoint presented_at{};
};

/// Returns <run_dir>/head-<head>.picture; bytes of `head` that are not allowed in a file name are written as %XX.
[[nodiscard]] std::filesystem::path shared_picture_path(const std::filesystem::path& run_dir, std::string_view head);

/// Thread-bound; readers may be in any process. Never blocks on a reader.
class SharedPictureWriter {
 public:
  /// Replaces a file of that name; its readers then get kUnavailable. Makes no folders.
  /// Errors: kInvalidArgument if a side is not 1 to 16384 px; kNotFound if there is no such folder; kSystem with the
  /// text of errno.
  static Result<SharedPictureWriter> create(const std::filesystem::path& path, int width, int height);
  SharedPictureWriter(SharedPictureWriter&&) noexcept;
  SharedPictureWriter& operator=(SharedPictureWriter&&) noexcept;
  ~SharedPictureWriter();

  /// Precondition: `picture` has the size given to create(). `info.picture` is ignored, since the writer counts.
  void publish(const RgbImage& picture, const SharedPictureInfo& info);

 private:
  struct Mapping;
  explicit SharedPictureWriter(std::unique_ptr<Mapping> mapping);
  std::unique_ptr<Mapping> mapping_;
};

/// Thread-bound.
class SharedPictureReader {
 public:
  /// Errors: kNotFound if no writer has made the file yet; kBadData if the file is not a shared picture or has another
  /// version; kSystem with the text of errno.
  static Result<SharedPictureReader> open(const std::filesystem::path& path);
  SharedPictureReader(SharedPictureReader&&) noexcept;
  SharedPictureReader& operator=(SharedPictureReader&&) noexcept;
  ~SharedPictureReader();

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;

  /// Copies the newest complete picture into `*ret_picture`, which is resized if necessary and otherwise reused. Does
  /// not block. The picture of a live writer that publishes nothing new remains valid, as on a projector;
  /// `presented_at` shows its age.
  /// Errors: kUnavailable if the writer is gone (open again) or nothing was published yet; kBusy if the writer was
  /// faster than this reader several times in a row; try again.
  Result<SharedPictureInfo> read_newest(RgbImage* ret_picture);

 private:
  struct Mapping;
  explicit SharedPictureReader(std::unique_ptr<Mapping> mapping);
  std::unique_ptr<Mapping> mapping_;
};

}  // namespace cyclorama::output
