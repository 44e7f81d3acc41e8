// SPDX-License-Identifier: Apache-2.0
/// EXT_meshopt_compression and KHR_meshopt_compression: compressed buffer views. Source: the extensions' specifications
/// in Khronos' glTF repository. Streams and filters of the second are read under the name of the first, too.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_json.h"

namespace cyclorama::scene {

/// Decodes `stored`, the part of a buffer to which `extension` refers, into count x byteStride bytes. Decoded indices
/// may be out of range, as in any buffer. Errors: kBadData for a mode, filter or stride that the extension does not
/// allow, for damaged data, and, before memory is allocated, for a count that `stored` cannot contain or that exceeds
/// the budget.
Result<std::vector<std::byte>> decode_meshopt(const GltfObject& extension, std::span<const std::byte> stored,
                                              GltfBudget* budget);

}  // namespace cyclorama::scene
