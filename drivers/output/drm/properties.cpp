// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/properties.h"

#include <fmt/format.h>

namespace cyclorama::output {

Result<Properties> Properties::read(int fd, std::uint32_t object_id, std::uint32_t type) {
  const KmsProperties listed(drmModeObjectGetProperties(fd, object_id, type));
  if (listed == nullptr) return Error::from_errno(fmt::format("listing the properties of KMS object {}", object_id));
  Properties properties;
  properties.object_id_ = object_id;
  for (std::uint32_t i = 0; i < listed->count_props; ++i) {
    const KmsProperty property(drmModeGetProperty(fd, listed->props[i]));
    if (property == nullptr) return Error::from_errno(fmt::format("reading KMS property {}", listed->props[i]));
    Property read{property->name, property->prop_id, listed->prop_values[i], 0};
    if (drm_property_type_is(property.get(), DRM_MODE_PROP_RANGE) != 0 && property->count_values == 2)
      read.max = property->values[1];
    properties.properties_.push_back(std::move(read));
  }
  return properties;
}

const Property* Properties::find(std::string_view name) const {
  for (const Property& property : properties_) {
    if (property.name == name) return &property;
  }
  return nullptr;
}

}  // namespace cyclorama::output
