// SPDX-License-Identifier: Apache-2.0
/// Outermost layer of a file: finds the JSON and the binary chunk, and parses the JSON within bounds.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"

namespace cyclorama::scene {

/// Borrows the file's bytes.
struct GltfChunks {
  std::string_view json;
  std::optional<std::span<const std::byte>> binary;
  bool has_unpadded_chunk = false;  ///< A chunk's length is not a multiple of 4, contrary to the specification.
};

/// Finds the chunks of a .glb or .gltf file. Errors: kBadData for any other content and for a damaged .glb. A chunk
/// length that is not a multiple of 4 is accepted if the next chunk or the end of the file shows whether the chunk is
/// padded. Source: glTF 2.0, section 4.4.
Result<GltfChunks> split_gltf(std::span<const std::byte> bytes);

/// Parses JSON without recursion. Text that is nested too deeply, or whose tree would exceed the budget, is refused
/// before anything is built.
Status parse_gltf_json(std::string_view text, GltfBudget* budget, nlohmann::json* ret_root);

}  // namespace cyclorama::scene
