// SPDX-License-Identifier: Apache-2.0
/// The correspondences of one projector from one direction of the turntable, and the folder that stores them so that an
/// interrupted scan can be resumed.
///
///     FOLDER/manifest.json      identity of the scan and list of its views; replaced by a rename
///     FOLDER/D-P.view           correspondences of direction D and projector P, written before the manifest names them
///
/// A view stores decoded correspondences instead of photographs: some megabytes instead of some hundred.
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

/// Measurement of one projector from one direction. A value.
struct ScanView {
  std::size_t direction = 0;
  std::size_t projector = 0;
  double angle_rad = 0.0;   ///< Reported by the turntable.
  double exposure_s = 0.0;  ///< 0 if the projector lights nothing in this direction.
  double disturbed = 0.0;   ///< Fraction of the lit pixels that something moving has disturbed.
  int pictures = 0;         ///< Photographs taken, over all attempts.
  std::vector<solve::Correspondence> correspondences{};
};

/// Identity of a scan: a scan may be resumed only with views of an equal identity. A value.
struct ScanIdentity {
  struct Projector {
    std::string name;
    int width_px = 0;
    int height_px = 0;
    friend bool operator==(const Projector&, const Projector&) = default;
  };
  std::string camera;  ///< Camera id.
  int camera_width_px = 0;
  int camera_height_px = 0;
  std::vector<Projector> projectors;
  std::vector<double> angles_rad;  ///< Planned angles.
  std::string patterns;            ///< ViewSettings::text(): the way of measuring.

  friend bool operator==(const ScanIdentity&, const ScanIdentity&) = default;
};

/// Contents of manifest.json. A value.
struct ScanManifest {
  struct Entry {
    ScanView view;  ///< Without its correspondences.
    std::size_t correspondences = 0;
    std::string checksum;  ///< Checksum of the view's file: 16 hexadecimal digits.
  };
  ScanIdentity identity;
  std::vector<Entry> entries;
};

[[nodiscard]] std::string manifest_text(const ScanManifest& manifest);
/// Parses the result of manifest_text(). `name` is the file's name in errors. Errors: kBadData, as in "manifest.json:
/// /views/0/direction: ...; remedy".
Result<ScanManifest> parse_manifest(std::string_view text, const std::string& name);

/// Encodes correspondences as bytes, and decodes them. Errors: kBadData for malformed bytes, or positions outside the
/// camera's or projector's picture.
[[nodiscard]] std::vector<std::byte> encode_correspondences(std::span<const solve::Correspondence> correspondences);
Result<std::vector<solve::Correspondence>> decode_correspondences(std::span<const std::byte> bytes,
                                                                  const ScanIdentity& identity, std::size_t projector);

/// The folder of a scan's views. Thread-bound.
class ScanFolder {
 public:
  /// Creates the folder and removes an earlier scan from it. Errors: kSystem with the reason from errno.
  static Result<ScanFolder> begin(std::filesystem::path folder, const ScanIdentity& identity);
  /// Resumes the scan in the folder. Errors: kNotFound if there is none; kBadData, with the difference and the remedy,
  /// if it is damaged, has another identity, or is more than half a day old, since projectors move in that time.
  static Result<ScanFolder> resume(std::filesystem::path folder, const ScanIdentity& identity);

  /// Removes a scan that has been calibrated, so that it cannot be resumed.
  static void end(const std::filesystem::path& folder);

  /// Returns the view of a direction and projector; null if there is none. The pointer is valid until the next keep().
  [[nodiscard]] const ScanView* find(std::size_t direction, std::size_t projector) const;
  [[nodiscard]] const std::vector<ScanView>& views() const { return views_; }
  /// Writes the view to the disk; replaces an earlier view of the same direction and projector. Errors: kSystem with
  /// the reason from errno, such as a full disk.
  Status keep(ScanView view);

 private:
  ScanFolder(std::filesystem::path folder, ScanIdentity identity)
      : folder_(std::move(folder)), manifest_{std::move(identity), {}} {}
  std::filesystem::path folder_;
  ScanManifest manifest_;
  std::vector<ScanView> views_;
};

}  // namespace cyclorama::scan
