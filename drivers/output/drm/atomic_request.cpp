// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/atomic_request.h"

#include <fmt/format.h>

namespace cyclorama::output {

AtomicRequest::AtomicRequest() : request_(drmModeAtomicAlloc()) {
  if (request_ == nullptr) mistake_ = kms_error(-ENOMEM, "making an atomic request");
}

void AtomicRequest::set(const Properties& object, std::string_view name, std::uint64_t value) {
  if (mistake_) return;
  const Property* const property = object.find(name);
  if (property == nullptr) {
    mistake_ =
        Error(ErrorCode::kUnavailable, fmt::format("KMS object {} has no property '{}'", object.object_id(), name));
    return;
  }
  const int result = drmModeAtomicAddProperty(request_.get(), object.object_id(), property->id, value);
  if (result < 0) mistake_ = kms_error(result, fmt::format("adding '{}' to an atomic request", name));
}

void AtomicRequest::set_if_known(const Properties& object, std::string_view name, std::uint64_t value) {
  if (object.find(name) != nullptr) set(object, name, value);
}

Status AtomicRequest::test_modeset(const Card& card) const {
  return commit(card, DRM_MODE_ATOMIC_TEST_ONLY | DRM_MODE_ATOMIC_ALLOW_MODESET, nullptr, "trying modes");
}

Status AtomicRequest::commit_modeset(const Card& card) const {
  return commit(card, DRM_MODE_ATOMIC_ALLOW_MODESET, nullptr, "setting modes");
}

Status AtomicRequest::start_modeset(const Card& card, void* cookie) const {
  return commit(card, DRM_MODE_ATOMIC_ALLOW_MODESET | DRM_MODE_ATOMIC_NONBLOCK | DRM_MODE_PAGE_FLIP_EVENT, cookie,
                "setting modes");
}

Status AtomicRequest::commit_flip(const Card& card, void* cookie) const {
  return commit(card, DRM_MODE_ATOMIC_NONBLOCK | DRM_MODE_PAGE_FLIP_EVENT, cookie, "flipping");
}

Status AtomicRequest::commit(const Card& card, std::uint32_t flags, void* cookie, std::string_view doing) const {
  if (mistake_) return *mistake_;
  if (const int result = drmModeAtomicCommit(card.fd(), request_.get(), flags, cookie); result != 0)
    return kms_error(result, fmt::format("{} on '{}'", doing, card.path().string()));
  return Done{};
}

Result<ModeBlob> ModeBlob::create(const Card& card, const drmModeModeInfo& mode) {
  ModeBlob blob;
  blob.fd_ = card.fd();
  if (const int result = drmModeCreatePropertyBlob(card.fd(), &mode, sizeof mode, &blob.id_); result != 0) {
    blob.id_ = 0;
    return kms_error(result, "describing a mode to the card");
  }
  return blob;
}

}  // namespace cyclorama::output
