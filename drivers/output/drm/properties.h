// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/output/drm/kms.h"

namespace cyclorama::output {

/// One of the kernel's properties of a CRTC, plane or connector.
struct Property {
  std::string name;
  std::uint32_t id = 0;
  std::uint64_t value = 0;  ///< When they were read.
  std::uint64_t max = 0;    ///< Of a range.
};

/// All that an object has. A value; reentrant.
class Properties {
 public:
  /// `type` is DRM_MODE_OBJECT_CRTC, _PLANE or _CONNECTOR. Errors as errno says.
  static Result<Properties> read(int fd, std::uint32_t object_id, std::uint32_t type);

  [[nodiscard]] std::uint32_t object_id() const { return object_id_; }
  /// Null where the driver does not have it.
  [[nodiscard]] const Property* find(std::string_view name) const;

 private:
  std::uint32_t object_id_ = 0;
  std::vector<Property> properties_;
};

}  // namespace cyclorama::output
