// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/wire/farm.pb.h"
#include "common/wire/view.pb.h"

namespace cyclorama::tour {

/// A converged picture as the farm sent it: displays show it like any other frame. A value.
struct KeptPicture {
  wire::View view;
  std::vector<wire::Tile> tiles;
  wire::FrameEnd end;
};

/// Returns the picture as a file: a title, its messages with their lengths, and a checksum of all.
[[nodiscard]] std::string to_bytes(const KeptPicture& picture);
/// Errors: kBadData if the file is damaged, or its messages are not one complete frame.
Result<KeptPicture> parse_kept_picture(std::string_view bytes);

/// The data with which a tour starts without its farm: the scene, and the picture that its displays need.
struct KeptVisit {
  wire::SceneDescription scene;
  wire::Panorama wanted;
};
[[nodiscard]] std::string to_bytes(const KeptVisit& visit);
/// Errors: kBadData if the file is damaged, or no visit could begin with it.
Result<KeptVisit> parse_kept_visit(std::string_view bytes);

/// Returns a checksum of the bytes (FNV-1a, 64 bits), against damage, not against forgery.
[[nodiscard]] std::uint64_t checksum_of(std::string_view bytes);

inline constexpr std::size_t kMaxKeptBytes = std::size_t{256} << 20;

}  // namespace cyclorama::tour
