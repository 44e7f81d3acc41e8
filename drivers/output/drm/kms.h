// SPDX-License-Identifier: Apache-2.0
/// Owning pointers for libdrm's objects, and conversion of its errors. Internal to the DRM output.
#pragma once

#include <xf86drm.h>
#include <xf86drmMode.h>

#include <memory>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::output {

template <auto Free>
struct KmsFree {
  void operator()(auto* pointer) const { Free(pointer); }
};
using KmsResources = std::unique_ptr<drmModeRes, KmsFree<drmModeFreeResources>>;
using KmsConnector = std::unique_ptr<drmModeConnector, KmsFree<drmModeFreeConnector>>;
using KmsPlaneResources = std::unique_ptr<drmModePlaneRes, KmsFree<drmModeFreePlaneResources>>;
using KmsPlane = std::unique_ptr<drmModePlane, KmsFree<drmModeFreePlane>>;
using KmsProperties = std::unique_ptr<drmModeObjectProperties, KmsFree<drmModeFreeObjectProperties>>;
using KmsProperty = std::unique_ptr<drmModePropertyRes, KmsFree<drmModeFreeProperty>>;
using KmsBlob = std::unique_ptr<drmModePropertyBlobRes, KmsFree<drmModeFreePropertyBlob>>;

/// Makes an error from a call that returned a negative errno. Callers in this folder branch on Error::errno_value().
Error kms_error(int negative_errno, std::string_view doing);

/// True if another process holds the DRM master right: presenting must wait for it.
[[nodiscard]] bool is_master_lost(const Error& error);
/// True if the card or its driver is gone: only reopening everything helps.
[[nodiscard]] bool is_card_lost(const Error& error);

}  // namespace cyclorama::output
