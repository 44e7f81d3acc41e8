// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/e57_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/text.h"
#include "renderfarm/scene/little_endian.h"
#include "renderfarm/scene/mesh_repair.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kMaxFields = 256;
enum PacketType : std::uint8_t { kIndexPacket = 0, kDataPacket = 1, kEmptyPacket = 2 };

Error bad_scan(std::string what) { return Error(ErrorCode::kBadData, std::move(what)); }

}  // namespace

Status E57Scan::read_prototype(const E57Node& points) {
  const E57Node* const prototype = points.child("prototype");
  if (prototype == nullptr || prototype->children.size() > kMaxFields) return bad_scan("its points have no prototype");
  constexpr std::array<std::pair<const char*, Role>, 12> kNames = {{{"cartesianX", kX},
                                                                    {"cartesianY", kY},
                                                                    {"cartesianZ", kZ},
                                                                    {"sphericalRange", kRange},
                                                                    {"sphericalAzimuth", kAzimuth},
                                                                    {"sphericalElevation", kElevation},
                                                                    {"colorRed", kRed},
                                                                    {"colorGreen", kGreen},
                                                                    {"colorBlue", kBlue},
                                                                    {"intensity", kIntensity},
                                                                    {"cartesianInvalidState", kInvalid},
                                                                    {"sphericalInvalidState", kInvalid}}};
  std::uint64_t bits = 0;
  for (const E57Node& child : prototype->children) {
    TRY_ASSIGN(E57Field field, E57Field::of(child));
    bits += static_cast<std::uint64_t>(field.bits());
    for (const auto& [name, role] : kNames) {
      if (child.name == name && !has(role)) role_[role] = fields_.size();
    }
    fields_.push_back(std::move(field));
  }
  const bool is_cartesian = has(kX) && has(kY) && has(kZ);
  if (!is_cartesian && !(has(kRange) && has(kAzimuth) && has(kElevation))) {
    return bad_scan("its points have neither x, y and z nor range, azimuth and elevation");
  }
  const auto count = parse_integer(points.attribute("recordCount"));
  if (!count || *count < 0) return bad_scan("its points have no number ('recordCount')");
  point_count_ = static_cast<std::uint64_t>(*count);
  const auto at = parse_integer(points.attribute("fileOffset"));
  if (!at || *at < 0) return bad_scan("its points have no place in the file ('fileOffset')");
  section_ = pages_.content_offset(static_cast<std::uint64_t>(*at));
  if (point_count_ > 0 && (bits == 0 || point_count_ > pages_.content_bytes() * 8 / bits)) {
    return bad_scan(fmt::format("its {} points of {} bits are more than the file holds", point_count_, bits));
  }
  return Done{};
}

void E57Scan::read_pose() {
  const E57Node* const pose = scan_.child("pose");
  if (pose == nullptr) return;
  if (const E57Node* const rotation = pose->child("rotation")) {
    const Eigen::Quaterniond turn(rotation->number_of_child("w"), rotation->number_of_child("x"),
                                  rotation->number_of_child("y"), rotation->number_of_child("z"));
    if (turn.norm() > 1e-6 && std::isfinite(turn.norm())) T_file_scan_.linear() = turn.normalized().toRotationMatrix();
  }
  if (const E57Node* const move = pose->child("translation")) {
    T_file_scan_.translation() =
        Eigen::Vector3d(move->number_of_child("x"), move->number_of_child("y"), move->number_of_child("z"));
  }
}

/// Returns the range of a brightness: the scan's limits if it states them, else the limits of the field.
E57Scan::Limits E57Scan::limits_of(Role role, const char* group, const char* name) const {
  if (!has(role)) return {};
  if (const E57Node* const stated = scan_.child(group)) {
    const Limits limits{stated->number_of_child(fmt::format("{}Minimum", name)),
                        stated->number_of_child(fmt::format("{}Maximum", name))};
    if (limits.maximum > limits.minimum) return limits;
  }
  const E57Field& field = fields_[role_[role]];
  return field.maximum() > field.minimum() ? Limits{field.minimum(), field.maximum()} : Limits{};
}

Result<E57Scan> E57Scan::open(const E57Pages& pages, const E57Node& scan) {
  E57Scan opened(pages, scan);
  const E57Node* const points = scan.child("points");
  if (points == nullptr || points->attribute("type") != "CompressedVector") return bad_scan("a scan has no points");
  TRY(opened.read_prototype(*points));
  opened.read_pose();
  opened.brightness_ = {opened.limits_of(kRed, "colorLimits", "colorRed"),
                        opened.limits_of(kGreen, "colorLimits", "colorGreen"),
                        opened.limits_of(kBlue, "colorLimits", "colorBlue"),
                        opened.limits_of(kIntensity, "intensityLimits", "intensity")};
  return opened;
}

Status E57Scan::take_packet(std::span<const std::byte> packet) {
  constexpr std::size_t kHeaderBytes = 6;
  if (packet.size() < kHeaderBytes + 2 * fields_.size()) return bad_scan("a packet of its points is too short");
  if (little_endian<std::uint16_t>(packet, 4) != fields_.size()) {
    return bad_scan(fmt::format("a packet of its points has {} streams for {} fields",
                                little_endian<std::uint16_t>(packet, 4), fields_.size()));
  }
  std::size_t at = kHeaderBytes + 2 * fields_.size();
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const std::size_t bytes = little_endian<std::uint16_t>(packet, kHeaderBytes + 2 * i);
    if (bytes > packet.size() - at) return bad_scan("a packet of its points is shorter than its streams");
    fields_[i].append(packet.subspan(at, bytes));
    at += bytes;
  }
  return Done{};
}

PointCloud::Colour E57Scan::colour_of(const std::vector<double>& row) const {
  const auto byte_of = [&](Role role, const Limits& limits) {
    return to_byte(255.0 * (row[role_[role]] - limits.minimum) / (limits.maximum - limits.minimum));
  };
  if (has_colour()) {
    return {byte_of(kRed, brightness_[0]), byte_of(kGreen, brightness_[1]), byte_of(kBlue, brightness_[2])};
  }
  PointCloud::Colour grey;
  grey.fill(has_intensity() ? byte_of(kIntensity, brightness_[3]) : std::uint8_t{255});
  return grey;
}

void E57Scan::add_point(const std::vector<double>& row, PointCloud* cloud) const {
  if (has(kInvalid) && row[role_[kInvalid]] != 0.0) return;
  Eigen::Vector3d p;
  if (has(kX) && has(kY) && has(kZ)) {
    p = {row[role_[kX]], row[role_[kY]], row[role_[kZ]]};
  } else {
    const double range = row[role_[kRange]];
    const double azimuth = row[role_[kAzimuth]];
    const double elevation = row[role_[kElevation]];
    p = range * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation));
  }
  cloud->add(T_file_scan_ * p, colour_of(row));
}

Status E57Scan::read(PointCloud* cloud) && {
  constexpr std::uint64_t kSectionHeaderBytes = 32;
  TRY_ASSIGN(const std::vector<std::byte> header, pages_.read(section_, kSectionHeaderBytes));
  if (header[0] != std::byte{1}) return bad_scan("the section of its points does not begin as one");
  const auto section_bytes = little_endian<std::uint64_t>(header, 8);
  std::uint64_t at = pages_.content_offset(little_endian<std::uint64_t>(header, 16));
  const std::uint64_t content_left = pages_.content_bytes() - std::min(section_, pages_.content_bytes());
  const std::uint64_t end = section_ + std::min(section_bytes, content_left);
  std::vector<double> row(fields_.size());
  for (std::uint64_t done = 0; done < point_count_;) {
    if (at >= end) {
      return bad_scan(
          fmt::format("its packets end after {} of {} points: it is damaged; copy it again", done, point_count_));
    }
    TRY_ASSIGN(const std::vector<std::byte> packet_header, pages_.read(at, 4));
    const auto type = static_cast<std::uint8_t>(packet_header[0]);
    const std::uint64_t packet_bytes = std::uint64_t{little_endian<std::uint16_t>(packet_header, 2)} + 1;
    if (type > kEmptyPacket) return bad_scan(fmt::format("a packet of its points has the type {}", type));
    if (type == kDataPacket) {
      TRY_ASSIGN(const std::vector<std::byte> packet, pages_.read(at, packet_bytes));
      TRY(take_packet(packet));
    }
    at += packet_bytes;
    std::uint64_t complete = point_count_ - done;
    for (const E57Field& field : fields_) complete = std::min(complete, field.available());
    for (std::uint64_t i = 0; i < complete; ++i) {
      std::transform(fields_.begin(), fields_.end(), row.begin(), [](E57Field& field) { return field.next(); });
      add_point(row, cloud);
    }
    done += complete;
    for (E57Field& field : fields_) field.forget_taken();
  }
  return Done{};
}

}  // namespace cyclorama::scene
