// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace cyclorama::light_baking {

/// Returns the build id that the linker gave this program, a hash of its code; empty if it has none. Results that are
/// kept on the disk are those of this program alone, even if another one has the same version.
[[nodiscard]] std::span<const std::byte> program_id();

}  // namespace cyclorama::light_baking
