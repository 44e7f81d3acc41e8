// SPDX-License-Identifier: Apache-2.0
/// VESA MPCDI 1.0 and 2.0: what calibrations of VIOSO, Scalable Display, domeprojection, Christie and others export,
/// and what media servers and game engines play. A zip archive with mpcdi.xml and its maps: PFM for geometry, PNG for
/// masks.
///
/// Sources: VESA MPCDI 1.0 and 2.0; where their text is silent or tools differ, what tools do: Scalable Display's
/// reference library (2013), PyMPCDI, SGCT, Unreal's nDisplay, Christie's "MPCDI explained".
/// docs/reference/interchange.md lists each such choice.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

struct MpcdiFile {
  WarpSet set;
  /// What the file has and nothing here uses, with its line: colour tables, extensions, unknown words. For people.
  std::vector<std::string> ignored;
};

/// A .mpcdi archive, or its bare mpcdi.xml (projector poses alone, as Christie writes them).
/// kBadData  "member 'x': ..." or "mpcdi.xml, line 12, <region>: ...", with the remedy. Reentrant.
Result<MpcdiFile> decode_mpcdi(std::span<const std::byte> bytes, const WarpLimits& limits = {});
/// As decode_mpcdi(); errors name the file too.
Result<MpcdiFile> read_mpcdi(const std::filesystem::path& path, const WarpLimits& limits = {});

/// The same set gives the same bytes; reading them gives the set. Masks of any size and bits are kept.
/// kBadData  as check() says.     kInvalidArgument  a mask cannot be packed.
Result<std::vector<std::byte>> encode_mpcdi(const WarpSet& set);
/// Written whole or not at all.
Status write_mpcdi(const std::filesystem::path& path, const WarpSet& set);

}  // namespace cyclorama::interchange
