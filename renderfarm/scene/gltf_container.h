// SPDX-License-Identifier: Apache-2.0
/// The outermost layer: which bytes are JSON, which are the binary chunk, and the JSON parsed within bounds.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_context.h"

namespace cyclorama {

/// Borrows the file's bytes.
struct GltfChunks {
  std::string_view json;
  std::optional<std::span<const std::byte>> binary;
};

/// kBadData  neither .glb nor .gltf, or a damaged .glb. Source: glTF 2.0, section 4.4.
Result<GltfChunks> split_gltf(std::span<const std::byte> bytes);

/// Parses without recursion and refuses, before anything is built, text that is nested absurdly deep or whose tree
/// would not fit the budget.
Status parse_gltf_json(std::string_view text, GltfBudget* budget, nlohmann::json* ret_root);

}  // namespace cyclorama
