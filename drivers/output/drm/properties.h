// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/output/drm/kms.h"

namespace cyclorama::output {

/// A KMS property of a CRTC, plane or connector.
struct Property {
  std::string name;
  std::uint32_t id = 0;
  std::uint64_t value = 0;  ///< Value at the time of reading.
  std::uint64_t max = 0;    ///< Upper bound of a range property.
};

/// All properties of an object. A value; reentrant.
class Properties {
 public:
  /// `type` is DRM_MODE_OBJECT_CRTC, _PLANE or _CONNECTOR. Errors: from errno.
  static Result<Properties> read(int fd, std::uint32_t object_id, std::uint32_t type);

  [[nodiscard]] std::uint32_t object_id() const { return object_id_; }
  /// Returns the property, or null if the driver does not have it.
  [[nodiscard]] const Property* find(std::string_view name) const;

 private:
  std::uint32_t object_id_ = 0;
  std::vector<Property> properties_;
};

}  // namespace cyclorama::output
