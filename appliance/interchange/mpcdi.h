// SPDX-License-Identifier: Apache-2.0
/// VESA MPCDI 1.0 and 2.0: the format that calibration programs of VIOSO, Scalable Display, domeprojection, Christie
/// and others export, and that media servers and game engines read. It is a zip archive with mpcdi.xml and maps: PFM
/// for geometry, PNG for masks.
///
/// Sources: VESA MPCDI 1.0 and 2.0; where their text is silent or tools differ, the behaviour of tools: Scalable
/// Display's reference library (2013), PyMPCDI, SGCT, Unreal's nDisplay, Christie's "MPCDI explained".
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
  /// Parts of the file that are not used, with their lines: colour tables, extensions, unknown words. For display to
  /// users.
  std::vector<std::string> ignored;
};

/// Decodes a .mpcdi archive, or a bare mpcdi.xml (projector poses alone, as Christie writes them). Errors: kBadData
/// "member 'x': ..." or "mpcdi.xml, line 12, <region>: ...", with the remedy. Reentrant.
Result<MpcdiFile> decode_mpcdi(std::span<const std::byte> bytes, const WarpLimits& limits = {});
/// Does the same for a file; errors also name the file.
Result<MpcdiFile> read_mpcdi(const std::filesystem::path& path, const WarpLimits& limits = {});

/// Encodes a set. Equal sets give equal bytes, and decoding these gives an equal set. Masks of any size and bits are
/// kept. Errors: those of check(); kInvalidArgument if a mask cannot be packed.
Result<std::vector<std::byte>> encode_mpcdi(const WarpSet& set);
/// Writes the file completely or not at all.
Status write_mpcdi(const std::filesystem::path& path, const WarpSet& set);

}  // namespace cyclorama::interchange
