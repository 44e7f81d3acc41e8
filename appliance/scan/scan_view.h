// SPDX-License-Identifier: Apache-2.0
/// What one direction of the turntable saw of one projector, and the folder that keeps it, so that a scan that was cut
/// short goes on where it was.
///
///     FOLDER/manifest.json      which scan this is, and which views there are; replaced by a rename
///     FOLDER/D-P.view           of direction D and projector P: places, written before the manifest names them
///
/// Views are what was decoded, not photographs: a view is some megabytes instead of some hundred.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/solve/measurements.h"
#include "common/base/result.h"

namespace cyclorama::scan {

/// A value.
struct ScanView {
  std::size_t direction = 0;
  std::size_t projector = 0;
  double angle_rad = 0.0;   ///< As the turntable told.
  double exposure_s = 0.0;  ///< 0: the projector lights nothing here.
  double disturbed = 0.0;   ///< Of the lit pixels: something moved before them.
  int pictures = 0;         ///< Photographs that it took, of all tries.
  std::vector<solve::Correspondence> correspondences{};
};

/// What makes two scans the same, so that one can go on with the other's views. A value.
struct ScanIdentity {
  struct Projector {
    std::string name;
    int width_px = 0;
    int height_px = 0;
    friend bool operator==(const Projector&, const Projector&) = default;
  };
  std::string camera;  ///< Its id.
  int camera_width_px = 0;
  int camera_height_px = 0;
  std::vector<Projector> projectors;
  std::vector<double> angles_rad;  ///< As planned.
  std::string patterns;            ///< What tells one way to measure from another.

  friend bool operator==(const ScanIdentity&, const ScanIdentity&) = default;
};

/// What manifest.json says. A value.
struct ScanManifest {
  struct Entry {
    ScanView view;  ///< Without its places.
    std::size_t correspondences = 0;
    std::string checksum;  ///< Of the view's file: 16 hexadecimal digits.
  };
  ScanIdentity identity;
  std::vector<Entry> entries;
};

[[nodiscard]] std::string manifest_text(const ScanManifest& manifest);
/// The opposite. `name` stands for the file in errors. kBadData  "manifest.json: /views/0/direction: ...; remedy".
Result<ScanManifest> parse_manifest(std::string_view text, const std::string& name);

/// PicturePositions as bytes, and back. kBadData  bytes that are none, or places that no camera or projector of these sizes has.
[[nodiscard]] std::vector<std::byte> encode_correspondences(std::span<const solve::Correspondence> correspondences);
Result<std::vector<solve::Correspondence>> decode_correspondences(std::span<const std::byte> bytes,
                                                                  const ScanIdentity& identity, std::size_t projector);

/// Thread-bound.
class ScanFolder {
 public:
  /// Makes the folder, and empties it of an earlier scan. kSystem  errno says why.
  static Result<ScanFolder> begin(std::filesystem::path folder, const ScanIdentity& identity);
  /// Goes on with what is there. kNotFound  nothing is.     kBadData  it is damaged, of another scan, or was left alone
  /// for half a day, in which projectors move: says what differs, and what to do.
  static Result<ScanFolder> resume(std::filesystem::path folder, const ScanIdentity& identity);

  /// What it was for has been calibrated: there is nothing to go on with any more.
  static void end(const std::filesystem::path& folder);

  /// Null: it is not there. Lives until the next keep().
  [[nodiscard]] const ScanView* find(std::size_t direction, std::size_t projector) const;
  [[nodiscard]] const std::vector<ScanView>& views() const { return views_; }
  /// Kept before it returns; the place of an earlier one of the same direction and projector is taken.
  /// kSystem  errno says why: the disk is full...
  Status keep(ScanView view);

 private:
  ScanFolder(std::filesystem::path folder, ScanIdentity identity)
      : folder_(std::move(folder)), manifest_{std::move(identity), {}} {}
  std::filesystem::path folder_;
  ScanManifest manifest_;
  std::vector<ScanView> views_;
};

}  // namespace cyclorama::scan
