// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "drivers/output/drm/card.h"

namespace cyclorama::output {

/// Changes to a card that are applied together or not at all. Thread-bound.
class AtomicRequest {
 public:
  AtomicRequest();

  /// Sets a property by name. The first property that the driver lacks, or that cannot be added, is reported by the
  /// commit or test, so that building a request needs no error handling.
  void set(const Properties& object, std::string_view name, std::uint64_t value);
  /// Sets the property if the driver has it.
  void set_if_known(const Properties& object, std::string_view name, std::uint64_t value);

  /// Tests whether commit_modeset() would succeed; changes nothing.
  [[nodiscard]] Status test_modeset(const Card& card) const;
  /// Commits a modeset and waits for its completion. Screens may go dark for a moment.
  [[nodiscard]] Status commit_modeset(const Card& card) const;
  /// Begins a modeset without blocking; one page-flip event with `cookie` follows for each CRTC in the request. Errors:
  /// EBUSY if an earlier commit on one of them is not complete.
  [[nodiscard]] Status start_modeset(const Card& card, void* cookie) const;
  /// Commits without blocking; one page-flip event with `cookie` follows for each CRTC in the request.
  [[nodiscard]] Status commit_flip(const Card& card, void* cookie) const;

 private:
  [[nodiscard]] Status commit(const Card& card, std::uint32_t flags, void* cookie, std::string_view doing) const;

  std::unique_ptr<drmModeAtomicReq, KmsFree<drmModeAtomicFree>> request_;
  std::optional<Error> mistake_;
};

/// A mode as a property blob of the card. Move-only; borrows the card's fd.
class ModeBlob {
 public:
  ModeBlob() = default;
  /// Errors: from errno.
  static Result<ModeBlob> create(const Card& card, const drmModeModeInfo& mode);
  ModeBlob(ModeBlob&& other) noexcept : fd_(other.fd_), id_(std::exchange(other.id_, 0)) {}
  ModeBlob& operator=(ModeBlob&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(id_, other.id_);
    return *this;
  }
  /// A blob that cannot be destroyed is freed with the file descriptor.
  ~ModeBlob() {
    if (id_ != 0) drmModeDestroyPropertyBlob(fd_, id_);
  }
  [[nodiscard]] std::uint32_t id() const { return id_; }

 private:
  int fd_ = -1;
  std::uint32_t id_ = 0;
};

}  // namespace cyclorama::output
