// SPDX-License-Identifier: Apache-2.0
#include "common/image/radiance_hdr.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/text.h"
#include "common/image/radiance_file.h"

namespace cyclorama {
namespace {

constexpr std::size_t kLineLimitBytes = 4096;
constexpr int kMinRleWidth = 8;  ///< Narrower or wider rows are never in the newer scheme.
constexpr int kMaxRleWidth = 32767;

using Texel = std::array<std::uint8_t, 4>;  ///< R, G, B, exponent.

struct Header {
  std::array<float, 3> scale{1.0f, 1.0f, 1.0f};  ///< Factor from stored values to radiance.
  /// Number of stored rows, along the picture's y unless `columns_first`.
  int rows = 0;
  int length = 0;  ///< Number of texels in a stored row.
  bool columns_first = false;
  bool x_backwards = false;
  bool y_upwards = false;
};

/// Reads from the front and keeps its position.
class HdrReader {
 public:
  explicit HdrReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  Error bad(std::string_view what) const {
    return Error(ErrorCode::kBadData, fmt::format("byte {}: {}; copy or export the picture again", at_, what));
  }

  Result<Header> header() {
    Header header;
    TRY_ASSIGN(std::string line, this->line());
    if (!line.starts_with("#?")) return bad("this is no Radiance HDR picture");
    while (true) {
      TRY_ASSIGN(line, this->line());
      if (line.empty()) break;
      TRY(variable(line, &header));
    }
    TRY_ASSIGN(line, this->line());
    TRY(resolution(line, &header));
    return header;
  }

  /// Reads one row, in either scheme.
  Status row(std::vector<Texel>* ret_row) {
    const auto length = static_cast<int>(ret_row->size());
    const bool may_be_new = length >= kMinRleWidth && length <= kMaxRleWidth && left() >= 4;
    if (!may_be_new || byte(0) != 2 || byte(1) != 2 || byte(2) >= 128) return old_row(ret_row);
    if (256 * byte(2) + byte(3) != length) return bad("the row is not as long as the header says");
    at_ += 4;
    for (std::size_t channel = 0; channel < 4; ++channel) TRY(new_channel(channel, ret_row));
    return Done{};
  }

 private:
  [[nodiscard]] std::uint8_t byte(std::size_t ahead) const {
    return std::to_integer<std::uint8_t>(bytes_[at_ + ahead]);
  }

  Result<std::string> line() {
    std::string text;
    while (left() > 0 && text.size() < kLineLimitBytes) {
      const char c = static_cast<char>(byte(0));
      ++at_;
      if (c == '\n') {
        if (!text.empty() && text.back() == '\r') text.pop_back();
        return text;
      }
      text += c;
    }
    return bad("the header does not end");
  }

  Status variable(std::string_view line, Header* header) const {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || line.front() == '#') return Done{};
    const std::string_view name = line.substr(0, equals);
    std::string_view value = line.substr(equals + 1);
    const auto word = [&] {
      const std::size_t begin = std::min(value.find_first_not_of(" \t"), value.size());
      const std::size_t end = std::min(value.find_first_of(" \t", begin), value.size());
      const std::string_view found = value.substr(begin, end - begin);
      value.remove_prefix(end);
      return found;
    };
    if (name == "FORMAT" && word() != "32-bit_rle_rgbe") {
      return bad(fmt::format("'{}' is not red, green and blue (32-bit_rle_rgbe)", printable(line)));
    }
    if (name != "EXPOSURE" && name != "COLORCORR") return Done{};
    std::optional<double> factor;
    for (float& scale : header->scale) {
      if (!factor || name == "COLORCORR") factor = parse_double(word());
      if (!factor || !(*factor >= 1e-12 && *factor <= 1e12))
        return bad(fmt::format("'{}' is no factor", printable(line)));
      scale = static_cast<float>(static_cast<double>(scale) / *factor);
    }
    return Done{};
  }

  /// Parses "-Y 512 +X 1024": the axis that is stored first, and the directions.
  Status resolution(std::string_view line, Header* header) const {
    std::array<std::string_view, 4> words;
    for (std::string_view& word : words) {
      const std::size_t space = std::min(line.find(' '), line.size());
      word = line.substr(0, space);
      line.remove_prefix(std::min(space + 1, line.size()));
    }
    const auto axis = [](std::string_view word) {
      return word.size() == 2 && (word[0] == '+' || word[0] == '-') ? word[1] : '?';
    };
    const auto rows = parse_integer(words[1]);
    const auto length = parse_integer(words[3]);
    const auto is_size = [](const std::optional<long long>& v) { return v && *v >= 1 && *v <= (1 << 28); };
    header->columns_first = axis(words[0]) == 'X';
    const bool both =
        (axis(words[0]) == 'Y' && axis(words[2]) == 'X') || (axis(words[0]) == 'X' && axis(words[2]) == 'Y');
    if (!both || !is_size(rows) || !is_size(length) || !line.empty()) return bad("the header states no size");
    header->rows = static_cast<int>(*rows);
    header->length = static_cast<int>(*length);
    header->y_upwards = words[header->columns_first ? 2 : 0][0] == '+';
    header->x_backwards = words[header->columns_first ? 0 : 2][0] == '-';
    return Done{};
  }

  Status new_channel(std::size_t channel, std::vector<Texel>* ret_row) {
    for (std::size_t done = 0; done < ret_row->size();) {
      if (left() < 2) return bad("the picture ends within a row");
      const bool run = byte(0) > 128;
      const std::size_t count = run ? byte(0) - 128U : byte(0);
      if (count == 0 || count > ret_row->size() - done) return bad("a run leaves its row");
      if (!run && left() < 1 + count) return bad("the picture ends within a row");
      for (std::size_t i = 0; i < count; ++i) (*ret_row)[done + i][channel] = byte(run ? 1 : 1 + i);
      at_ += run ? 2 : 1 + count;
      done += count;
    }
    return Done{};
  }

  /// Reads a row in the older scheme: texels are literal, but (1, 1, 1, n) repeats the previous texel n times. If
  /// several of these follow each other directly, the second one means n * 256 times, the third n * 256^2 times, and so
  /// on.
  Status old_row(std::vector<Texel>* ret_row) {
    int shift = 0;
    for (std::size_t done = 0; done < ret_row->size();) {
      if (left() < 4) return bad("the picture ends within a row");
      const Texel texel{byte(0), byte(1), byte(2), byte(3)};
      if (texel[0] != 1 || texel[1] != 1 || texel[2] != 1) {
        (*ret_row)[done++] = texel;
        shift = 0;
      } else {
        const std::size_t count = shift < 32 ? std::size_t{texel[3]} << shift : 0;
        if (done == 0 || count > ret_row->size() - done || shift >= 32) return bad("a run leaves its row");
        std::fill_n(ret_row->begin() + static_cast<std::ptrdiff_t>(done), count, (*ret_row)[done - 1]);
        done += count;
        shift += 8;
      }
      at_ += 4;
    }
    return Done{};
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

/// Returns the minimum size of all rows: for a row, a run of 127 takes two bytes for each channel, or 256^4 texels take
/// four.
std::size_t min_bytes(const Header& header) {
  const auto rows = static_cast<std::size_t>(header.rows);
  return rows * (header.length <= kMinRleWidth ? 4 : 8);
}

}  // namespace

Result<RadianceImage> decode_radiance_hdr(std::span<const std::byte> bytes, std::size_t limit_px) {
  HdrReader reader(bytes);
  TRY_ASSIGN(const Header header, reader.header());
  const int width = header.columns_first ? header.rows : header.length;
  const int height = header.columns_first ? header.length : header.rows;
  if (static_cast<std::size_t>(width) > limit_px / static_cast<std::size_t>(height)) {
    return Error(ErrorCode::kBadData, fmt::format("the picture has {}x{} pixels; at most {} are accepted here; make it "
                                                  "smaller",
                                                  width, height, limit_px));
  }
  if (reader.left() < min_bytes(header)) return reader.bad(fmt::format("{} rows need more bytes", header.rows));
  RadianceImage image(width, height);
  std::vector<Texel> row(static_cast<std::size_t>(header.length));
  for (int i = 0; i < header.rows; ++i) {
    TRY(reader.row(&row));
    for (int j = 0; j < header.length; ++j) {
      const Texel& texel = row[static_cast<std::size_t>(j)];
      const int x = header.columns_first ? i : j;
      const int y = header.columns_first ? j : i;
      float* const out = image.at(header.x_backwards ? width - 1 - x : x, header.y_upwards ? height - 1 - y : y);
      const float unit = texel[3] == 0 ? 0.0f : std::ldexp(1.0f, texel[3] - 136);
      for (std::size_t c = 0; c < 3; ++c) {
        out[c] = sane_radiance(static_cast<float>(texel[c]) * unit * header.scale[c]);
      }
    }
  }
  return image;
}

}  // namespace cyclorama
