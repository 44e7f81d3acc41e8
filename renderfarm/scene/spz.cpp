// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/spz.h"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/base/file.h"
#include "renderfarm/scene/little_endian.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t kSpzHeaderBytes = 16;
constexpr std::size_t kSpz4HeaderBytes = 32;
constexpr std::uint32_t kSpzMagic = 0x5053474e;
constexpr std::uint64_t kMaxInflation = 1032;  ///< Maximum compression ratio of Deflate.

Error bad_spz(std::string_view what) { return Error(ErrorCode::kBadData, fmt::format("the SPZ {}", what)); }

struct SpzHeader {
  std::uint32_t version = 0;
  std::uint32_t count = 0;
  int degree = 0;
  int fractional_bits = 0;

  static Result<SpzHeader> read(Bytes bytes) {
    if (bytes.size() < kSpzHeaderBytes || little_endian<std::uint32_t>(bytes, 0) != kSpzMagic) {
      return bad_spz("has no header of SPZ; copy it again");
    }
    SpzHeader header;
    header.version = little_endian<std::uint32_t>(bytes, 4);
    header.count = little_endian<std::uint32_t>(bytes, 8);
    header.degree = little_endian<std::uint8_t>(bytes, 12);
    header.fractional_bits = little_endian<std::uint8_t>(bytes, 13);
    if (header.version < 2 || header.version > 4) {
      return bad_spz(fmt::format("is of version {}; 2 to 4 can be read", header.version));
    }
    if (header.degree > kMaxSplatDegree) {
      return bad_spz(fmt::format("has harmonics of degree {}; at most {} are known", header.degree, kMaxSplatDegree));
    }
    if (header.fractional_bits > 24)
      return bad_spz(fmt::format("has {} fractional bits of 24", header.fractional_bits));
    return header;
  }
  [[nodiscard]] std::size_t rotation_bytes() const { return version == 2 ? 3 : 4; }
  [[nodiscard]] std::size_t rest() const { return static_cast<std::size_t>((degree + 1) * (degree + 1) - 1); }
  /// Returns the bytes of one splat's position, opacity, colour, scale, rotation and harmonics.
  [[nodiscard]] std::array<std::size_t, 6> widths() const { return {9, 1, 3, 3, rotation_bytes(), 3 * rest()}; }
  [[nodiscard]] std::uint64_t packed_bytes() const {
    std::uint64_t each = 0;
    for (const std::size_t width : widths()) each += width;
    return each * count;
  }
};

/// The bytes of each attribute, splat by splat.
struct SpzParts {
  Bytes positions, opacities, colours, scales, rotations, harmonics;
};

/// Checks the number of splats. Errors: kBadData if they would need more memory than the limit, or more data than
/// `stored` bytes can contain.
Status check_count(const SpzHeader& header, std::uint64_t stored, std::uint64_t inflation, std::size_t limit_bytes) {
  if (header.packed_bytes() / inflation > stored) {
    return bad_spz(
        fmt::format("announces {} splats, but has only {} bytes: it is damaged; copy it again", header.count, stored));
  }
  const std::size_t each = bytes_per_splat(header.degree) + header.packed_bytes() / std::max(1u, header.count);
  if (header.count <= limit_bytes / each) return Done{};
  return bad_spz(fmt::format("has {} splats, which need more than the {} MiB that a scene may take; raise the limit",
                             header.count, limit_bytes >> 20));
}

/// Inflates `gzip` into exactly `ret_bytes`. Returns false if `gzip` is damaged or its content has another length.
bool inflate_all(Bytes gzip, std::span<std::byte> ret_bytes, bool may_go_on) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16;
  if (gzip.size() > std::numeric_limits<uInt>::max() || inflateInit2(&stream, kGzip) != Z_OK) return false;
  // zlib's input is not const, but zlib does not change it.
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  std::size_t done = 0;
  int state = Z_OK;
  while (state == Z_OK && done < ret_bytes.size()) {
    const std::size_t some = std::min<std::size_t>(ret_bytes.size() - done, std::numeric_limits<int>::max());
    stream.next_out = reinterpret_cast<Bytef*>(ret_bytes.data() + done);
    stream.avail_out = static_cast<uInt>(some);
    state = inflate(&stream, Z_NO_FLUSH);
    done += some - stream.avail_out;
    if (state == Z_BUF_ERROR) break;
  }
  Bytef beyond = 0;
  stream.next_out = &beyond;
  stream.avail_out = 1;
  if (state == Z_OK && !may_go_on) state = inflate(&stream, Z_FINISH);
  const bool is_whole = may_go_on || (state == Z_STREAM_END && stream.avail_out == 1);
  inflateEnd(&stream);
  return done == ret_bytes.size() && is_whole;
}

double byte_at(Bytes bytes, std::size_t at) { return static_cast<double>(bytes[at]); }

/// Decodes a rotation of version 2, which stores x, y and z; w is not negative.
Eigen::Quaterniond first_three(Bytes bytes, std::size_t at) {
  const Eigen::Vector3d v(byte_at(bytes, at) / 127.5 - 1.0, byte_at(bytes, at + 1) / 127.5 - 1.0,
                          byte_at(bytes, at + 2) / 127.5 - 1.0);
  return {std::sqrt(std::max(0.0, 1.0 - v.squaredNorm())), v.x(), v.y(), v.z()};
}

/// Decodes a rotation of later versions, which store the three smallest of x, y, z and w in 10 bits each, and the index
/// of the largest.
Eigen::Quaterniond smallest_three(Bytes bytes, std::size_t at) {
  auto packed = little_endian<std::uint32_t>(bytes, at);
  const std::uint32_t largest = packed >> 30;
  Eigen::Vector4d xyzw = Eigen::Vector4d::Zero();
  for (int i = 3; i >= 0; --i) {
    if (static_cast<std::uint32_t>(i) == largest) continue;
    const double size = std::sqrt(0.5) * (packed & 511u) / 511.0;
    xyzw[i] = (packed >> 9 & 1u) != 0 ? -size : size;
    packed >>= 10;
  }
  xyzw[static_cast<int>(largest)] = std::sqrt(std::max(0.0, 1.0 - xyzw.squaredNorm()));
  return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

SplatCloud unpack(const SpzHeader& header, const SpzParts& parts, std::size_t* ret_left_out) {
  SplatCloud cloud;
  cloud.degree = header.degree;
  std::vector<std::array<float, 3>> coefficients(cloud.coefficient_count());
  const double unit = 1.0 / static_cast<double>(1u << header.fractional_bits);
  for (std::size_t i = 0; i < header.count; ++i) {
    SplatValues values;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t at = 9 * i + 3 * axis;
      const auto low = static_cast<std::uint32_t>(parts.positions[at]);
      const auto middle = static_cast<std::uint32_t>(parts.positions[at + 1]);
      const auto high = static_cast<std::uint32_t>(parts.positions[at + 2]);
      const auto fixed = static_cast<std::int32_t>((low | middle << 8 | high << 16) << 8) >> 8;  // Extends the sign.
      values.position[static_cast<int>(axis)] = unit * fixed;
      values.scale[static_cast<int>(axis)] = std::exp(byte_at(parts.scales, 3 * i + axis) / 16.0 - 10.0);
    }
    values.opacity = byte_at(parts.opacities, i) / 255.0;
    const std::size_t turn = header.rotation_bytes() * i;
    values.rotation = header.version == 2 ? first_three(parts.rotations, turn) : smallest_three(parts.rotations, turn);
    for (std::size_t c = 0; c < 3; ++c) {
      constexpr double kColourScale = 0.15;
      coefficients[0][c] = static_cast<float>((byte_at(parts.colours, 3 * i + c) / 255.0 - 0.5) / kColourScale);
      for (std::size_t k = 0; k < header.rest(); ++k) {
        const std::size_t at = (i * header.rest() + k) * 3 + c;
        coefficients[1 + k][c] = static_cast<float>((byte_at(parts.harmonics, at) - 128.0) / 128.0);
      }
    }
    if (!add_splat(values, coefficients, &cloud)) ++*ret_left_out;
  }
  return cloud;
}

SpzParts parts_of(const SpzHeader& header, Bytes packed) {
  SpzParts parts;
  const std::array<Bytes*, 6> to = {&parts.positions, &parts.opacities, &parts.colours,
                                    &parts.scales,    &parts.rotations, &parts.harmonics};
  for (std::size_t i = 0; i < to.size(); ++i) {
    const std::size_t bytes = header.widths()[i] * header.count;
    *to[i] = packed.first(bytes);
    packed = packed.subspan(bytes);
  }
  return parts;
}

/// Decodes versions 2 and 3: one gzip stream.
Result<SplatCloud> decode_gzip(Bytes spz, std::size_t limit_bytes, std::size_t* ret_left_out) {
  std::array<std::byte, kSpzHeaderBytes> first{};
  if (!inflate_all(spz, first, true)) return bad_spz("is no gzip stream, or ends too early; copy it again");
  TRY_ASSIGN(const SpzHeader header, SpzHeader::read(first));
  TRY(check_count(header, spz.size(), kMaxInflation, limit_bytes));
  std::vector<std::byte> raw(kSpzHeaderBytes + header.packed_bytes());
  if (!inflate_all(spz, raw, false)) {
    return bad_spz(fmt::format("does not hold the {} splats that it announces; copy it again", header.count));
  }
  return unpack(header, parts_of(header, Bytes(raw).subspan(kSpzHeaderBytes)), ret_left_out);
}

/// Decodes version 4: a header, a table of streams with their sizes, and a Zstandard stream for each part.
Result<SplatCloud> decode_streams(Bytes spz, std::size_t limit_bytes, std::size_t* ret_left_out) {
  TRY_ASSIGN(const SpzHeader header, SpzHeader::read(spz));
  if (header.version == 4 && spz.size() >= kSpz4HeaderBytes) {
    constexpr std::uint64_t kMaxZstandard = std::uint64_t{1}
                                            << 17;  // A block of one repeated byte stores 128 KiB in a few bytes.
    TRY(check_count(header, spz.size(), kMaxZstandard, limit_bytes));
    const std::size_t streams = little_endian<std::uint8_t>(spz, 15);
    std::size_t table = little_endian<std::uint32_t>(spz, 16);
    const std::size_t expected = header.degree > 0 ? 6 : 5;
    if (streams < expected || table > spz.size() || (spz.size() - table) / 16 < streams) {
      return bad_spz("has no table of its streams; copy it again");
    }
    std::vector<std::byte> raw(header.packed_bytes());
    std::span<std::byte> to = raw;
    std::size_t at = table + 16 * streams;
    for (std::size_t i = 0; i < expected; ++i, table += 16) {
      const auto stored = little_endian<std::uint64_t>(spz, table);
      const std::size_t bytes = header.widths()[i] * header.count;
      if (stored > spz.size() - at || little_endian<std::uint64_t>(spz, table + 8) != bytes ||
          ZSTD_decompress(to.data(), bytes, spz.data() + at, stored) != bytes) {
        return bad_spz(fmt::format("has a damaged stream {} of {}; copy it again", i + 1, streams));
      }
      to = to.subspan(bytes);
      at += stored;
    }
    return unpack(header, parts_of(header, raw), ret_left_out);
  }
  return bad_spz("is not compressed, which version 4 only may be; export it again");
}

}  // namespace

bool is_bare_spz(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && little_endian<std::uint32_t>(bytes, 0) == kSpzMagic;
}

Result<SplatCloud> decode_spz(std::span<const std::byte> spz, std::size_t limit_bytes, std::size_t* ret_left_out) {
  *ret_left_out = 0;
  if (is_bare_spz(spz)) return decode_streams(spz, limit_bytes, ret_left_out);
  return decode_gzip(spz, limit_bytes, ret_left_out);
}

Result<Model> import_spz(const std::filesystem::path& path, const ImportLimits& limits) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  std::size_t left_out = 0;
  Result<SplatCloud> cloud = decode_spz(file.bytes(), limits.memory_bytes, &left_out);
  if (cloud && cloud->size() == 0) cloud = bad_spz("has no splats that can be seen");
  if (!cloud) return std::move(cloud).error().while_doing(fmt::format("'{}'", path.string()));
  Model model;
  model.materials.emplace_back();
  if (left_out > 0) model.notes.push_back(note_of_left_out(left_out));
  model.splats.push_back(*std::move(cloud));
  return model;
}

}  // namespace cyclorama::scene
