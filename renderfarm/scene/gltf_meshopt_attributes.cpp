// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_meshopt_attributes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace cyclorama::scene {
namespace {

constexpr std::byte kVersion1{0xa1};
constexpr std::size_t kGroup = 16;
constexpr std::size_t kMaxBlock = 256;
constexpr std::size_t kBlockBytes = 8192;
constexpr std::size_t kMinTail = 24;

/// The bits of each delta, by control mode and by the header bits of a group.
constexpr std::array<std::array<int, 4>, 2> kBits = {{{0, 1, 2, 4}, {1, 2, 4, 8}}};

unsigned value_of(std::byte byte) { return std::to_integer<unsigned>(byte); }

template <typename T>
T unzigzag(T v) {
  return static_cast<T>((v & 1) != 0 ? ~(v >> 1) : v >> 1);
}

/// Reads the bytes before the tail from front to back.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  [[nodiscard]] bool is_at_end() const { return rest_.empty(); }
  std::optional<std::span<const std::byte>> take(std::size_t bytes) {
    if (bytes > rest_.size()) return std::nullopt;
    const std::span<const std::byte> taken = rest_.first(bytes);
    rest_ = rest_.subspan(bytes);
    return taken;
  }

 private:
  std::span<const std::byte> rest_;
};

/// Returns delta `i` of a packed group. Single bits begin at the lowest of a byte, wider ones at the highest.
unsigned packed_delta(std::span<const std::byte> packed, std::size_t i, int bits) {
  const std::size_t in_byte = 8 / static_cast<std::size_t>(bits);
  const std::size_t at = i % in_byte;
  const std::size_t from_low = bits == 1 ? at : in_byte - 1 - at;
  const unsigned mask = (1u << bits) - 1;
  return (value_of(packed[i / in_byte]) >> (from_low * static_cast<std::size_t>(bits))) & mask;
}

bool read_group(Reader* reader, int bits, std::uint8_t* ret_deltas) {
  if (bits == 0) {
    std::fill_n(ret_deltas, kGroup, std::uint8_t{0});
    return true;
  }
  const auto packed = reader->take(kGroup * static_cast<std::size_t>(bits) / 8);
  if (!packed) return false;
  const unsigned sentinel = (1u << bits) - 1;
  for (std::size_t i = 0; i < kGroup; ++i) {
    unsigned delta = packed_delta(*packed, i, bits);
    if (bits < 8 && delta == sentinel) {
      const auto whole = reader->take(1);
      if (!whole) return false;
      delta = value_of(whole->front());
    }
    ret_deltas[i] = static_cast<std::uint8_t>(delta);
  }
  return true;
}

/// The deltas of one byte of all elements of a block.
using Deltas = std::array<std::uint8_t, kMaxBlock>;

bool read_deltas(Reader* reader, unsigned control, std::size_t count, Deltas* ret_deltas) {
  if (control == 2) {
    ret_deltas->fill(0);
    return true;
  }
  if (control == 3) {
    const auto bytes = reader->take(count);
    if (!bytes) return false;
    std::memcpy(ret_deltas->data(), bytes->data(), count);
    return true;
  }
  const std::size_t groups = (count + kGroup - 1) / kGroup;
  const auto header = reader->take((groups + 3) / 4);
  if (!header) return false;
  for (std::size_t g = 0; g < groups; ++g) {
    const unsigned mode = (value_of((*header)[g / 4]) >> (2 * (g % 4))) & 3u;
    if (!read_group(reader, kBits[control][mode], ret_deltas->data() + g * kGroup)) return false;
  }
  return true;
}

/// Adds the deltas of four bytes to the element before, and writes the elements of a block from `first` on.
class Channel {
 public:
  explicit Channel(unsigned mode) : kind_(mode & 15), rotation_(static_cast<int>(mode >> 4)) {}

  [[nodiscard]] bool is_valid() const { return kind_ == 2 || (kind_ < 2 && rotation_ == 0); }

  void restore(const std::array<Deltas, 4>& deltas, std::size_t count, std::size_t stride, std::byte* last,
               std::byte* first) const {
    std::array<std::uint8_t, 4> element{};
    std::memcpy(element.data(), last, element.size());
    for (std::size_t i = 0; i < count; ++i) {
      element = next(element, {deltas[0][i], deltas[1][i], deltas[2][i], deltas[3][i]});
      std::memcpy(first + i * stride, element.data(), element.size());
    }
    std::memcpy(last, element.data(), element.size());
  }

 private:
  using Four = std::array<std::uint8_t, 4>;

  template <typename T>
  static T word_of(const Four& bytes, std::size_t at) {
    T word = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) word = static_cast<T>(word | T{bytes[at + i]} << (8 * i));
    return word;
  }
  template <typename T>
  static void set_word(T word, std::size_t at, Four* bytes) {
    for (std::size_t i = 0; i < sizeof(T); ++i) (*bytes)[at + i] = static_cast<std::uint8_t>(word >> (8 * i));
  }

  [[nodiscard]] Four next(Four element, const Four& delta) const {
    if (kind_ == 2) {
      // The encoder rotated to the left.
      const std::uint32_t changed = std::rotr(word_of<std::uint32_t>(delta, 0), rotation_);
      set_word(word_of<std::uint32_t>(element, 0) ^ changed, 0, &element);
    } else if (kind_ == 1) {
      for (const std::size_t at : {std::size_t{0}, std::size_t{2}}) {
        const auto step = unzigzag(word_of<std::uint16_t>(delta, at));
        set_word(static_cast<std::uint16_t>(word_of<std::uint16_t>(element, at) + step), at, &element);
      }
    } else {
      for (std::size_t k = 0; k < 4; ++k) element[k] = static_cast<std::uint8_t>(element[k] + unzigzag(delta[k]));
    }
    return element;
  }

  unsigned kind_;
  int rotation_;
};

template <typename Unsigned, typename Signed>
void to_rgba(std::byte* bytes) {
  std::array<Unsigned, 4> in{};
  std::memcpy(in.data(), bytes, sizeof in);
  const int scale = (1 << std::bit_width(unsigned{in[3]})) - 1;
  const int luma = in[0];
  // NOLINTBEGIN(bugprone-signed-char-misuse): they are numbers, whose sign counts.
  const int co = static_cast<Signed>(in[1]);
  const int cg = static_cast<Signed>(in[2]);
  // NOLINTEND(bugprone-signed-char-misuse)
  const int short_alpha = in[3] & (scale >> 1);
  const std::array<int, 4> rgba = {luma + co - cg, luma + cg, luma - co - cg, short_alpha << 1 | (short_alpha & 1)};
  constexpr double kMax = static_cast<Unsigned>(-1);
  for (std::size_t i = 0; i < 4; ++i) {
    const double value = scale > 0 ? std::round(rgba[i] * (kMax / scale)) : 0.0;
    in[i] = static_cast<Unsigned>(std::clamp(value, 0.0, kMax));
  }
  std::memcpy(bytes, in.data(), sizeof in);
}

}  // namespace

bool is_meshopt_attributes_v1(std::span<const std::byte> stored) {
  return !stored.empty() && stored.front() == kVersion1;
}

std::optional<std::vector<std::byte>> decode_meshopt_attributes_v1(std::span<const std::byte> stored, std::size_t count,
                                                                   std::size_t stride) {
  const std::size_t channels = stride / 4;
  const std::size_t tail = std::max(stride + channels, kMinTail);
  if (!is_meshopt_attributes_v1(stored) || stored.size() < 1 + tail) return std::nullopt;
  const std::span<const std::byte> modes = stored.last(channels);
  const std::span<const std::byte> baseline = stored.last(channels + stride).first(stride);
  std::vector<std::byte> last(baseline.begin(), baseline.end());
  Reader reader(stored.subspan(1, stored.size() - 1 - tail));
  std::vector<std::byte> bytes(count * stride);
  const std::size_t max_block = std::min(kBlockBytes / stride / kGroup * kGroup, kMaxBlock);
  for (std::size_t first = 0; first < count; first += max_block) {
    const std::size_t in_block = std::min(max_block, count - first);
    const auto controls = reader.take(channels);
    if (!controls) return std::nullopt;
    for (std::size_t c = 0; c < channels; ++c) {
      const Channel channel(value_of(modes[c]));
      if (!channel.is_valid()) return std::nullopt;
      std::array<Deltas, 4> deltas;
      for (std::size_t k = 0; k < 4; ++k) {
        const unsigned control = (value_of((*controls)[c]) >> (2 * k)) & 3u;
        if (!read_deltas(&reader, control, in_block, &deltas[k])) return std::nullopt;
      }
      channel.restore(deltas, in_block, stride, last.data() + 4 * c, bytes.data() + first * stride + 4 * c);
    }
  }
  if (!reader.is_at_end()) return std::nullopt;
  return bytes;
}

void apply_meshopt_colour_filter(std::size_t stride, std::span<std::byte> bytes) {
  for (std::size_t at = 0; at < bytes.size(); at += stride) {
    if (stride == 4) {
      to_rgba<std::uint8_t, std::int8_t>(&bytes[at]);
    } else {
      to_rgba<std::uint16_t, std::int16_t>(&bytes[at]);
    }
  }
}

}  // namespace cyclorama::scene
