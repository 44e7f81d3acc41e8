// SPDX-License-Identifier: Apache-2.0
#include "common/edid/edid_timings.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "common/base/check.h"
#include "common/edid/timing_tables.h"

namespace cyclorama {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kMaxTimings = 128;

/// DMT ids of "Established Timings III" (table 3.28), from the first bit on.
constexpr std::array<int, 44> kEstablished3{0x01, 0x02, 0x03, 0x07, 0x0e, 0x0c, 0x13, 0x15, 0x16, 0x17, 0x18,
                                            0x19, 0x20, 0x21, 0x23, 0x25, 0x27, 0x2e, 0x2f, 0x30, 0x31, 0x29,
                                            0x2a, 0x2b, 0x2c, 0x39, 0x3a, 0x3b, 0x3c, 0x33, 0x34, 0x35, 0x36,
                                            0x37, 0x3e, 0x3f, 0x41, 0x42, 0x44, 0x45, 0x46, 0x47, 0x49, 0x4a};
/// DMT ids of the "Established Timings" I and II (table 3.18), from the first bit on; 0: timings of other makers, and
/// an interlaced one, which no projector needs.
constexpr std::array<int, 16> kEstablished{0,    0,    0x04, 0, 0x05, 0x06, 0x08, 0x09,
                                           0x0a, 0x0b, 0,    0, 0x10, 0x11, 0x12, 0x24};

/// Collects timings in the order of their rank.
class TimingList {
 public:
  void add(std::optional<VideoTiming> timing, bool is_preferred = false) {
    if (!timing || !timing->is_possible()) return;
    const auto same = std::find_if(timings_.begin(), timings_.end(), [&](VideoTiming other) {
      other.is_preferred = timing->is_preferred;
      return other == *timing;
    });
    if (same != timings_.end()) {
      same->is_preferred = same->is_preferred || is_preferred;
    } else if (timings_.size() < kMaxTimings) {
      timing->is_preferred = is_preferred;
      timings_.push_back(*timing);
    }
  }
  [[nodiscard]] std::vector<VideoTiming> take() {
    std::stable_partition(timings_.begin(), timings_.end(), [](const VideoTiming& t) { return t.is_preferred; });
    return std::move(timings_);
  }

 private:
  std::vector<VideoTiming> timings_;
};

/// Parses a detailed timing descriptor (table 3.21); nothing if it is something else.
std::optional<VideoTiming> detailed_timing(Bytes d) {
  const int clock_10khz = d[0] | d[1] << 8;
  if (clock_10khz == 0) return std::nullopt;
  const auto joined = [&](std::size_t low, std::size_t high, int shift, int mask) {
    return d[low] | (d[high] >> shift & mask) << 8;
  };
  VideoTiming timing;
  timing.clock_khz = 10 * clock_10khz;
  const auto axis = [](int visible, int blank, int front, int sync) {
    // Some devices state a sync pulse that ends behind the line; it is the blanking that is too short then.
    return TimingAxis{visible, front, sync, std::max(0, blank - front - sync), false};
  };
  timing.horizontal = axis(joined(2, 4, 4, 15), joined(3, 4, 0, 15), joined(8, 11, 6, 3), joined(9, 11, 4, 3));
  timing.vertical = axis(joined(5, 7, 4, 15), joined(6, 7, 0, 15), d[10] >> 4 | (d[11] >> 2 & 3) << 4,
                         (d[10] & 15) | (d[11] & 3) << 4);
  const bool is_separate = (d[17] & 0x18) == 0x18;
  timing.horizontal.is_sync_positive = is_separate && (d[17] & 2) != 0;
  timing.vertical.is_sync_positive = is_separate && (d[17] & 4) != 0;
  timing.is_interlaced = (d[17] & 0x80) != 0;
  if (timing.is_interlaced) timing.vertical.visible *= 2;
  return timing;
}

/// Parses a standard timing (table 3.19): a width, an aspect ratio and a rate.
std::optional<VideoTiming> standard_timing(std::uint8_t first, std::uint8_t second, int revision) {
  if (first <= 1) return std::nullopt;  // 0x01 marks an unused one; 0x00 is invalid.
  const int width = (first + 31) * 8;
  const int hz = (second & 63) + 60;
  const std::array<int, 4> heights{revision >= 3 ? width * 10 / 16 : width, width * 3 / 4, width * 4 / 5,
                                   width * 9 / 16};
  const int height = heights[second >> 6];
  // Panels of 1366 pixels cannot state their width in cells of 8.
  if (hz == 60 && height == 765) return dmt_timing(0x51);
  if (auto known = dmt_timing(width, height, hz)) return known;
  return coordinated_timing(width, height, hz, false);
}

void add_coordinated(Bytes code, TimingList* list) {
  const int height = 2 * ((code[0] | (code[1] >> 4 & 15) << 8) + 1);
  constexpr std::array<std::array<int, 2>, 4> kAspects{{{4, 3}, {16, 9}, {16, 10}, {15, 9}}};
  const auto& aspect = kAspects[code[1] >> 2 & 3];
  const int width = height * aspect[0] / aspect[1] / 8 * 8;
  if ((code[2] & 1) != 0) list->add(coordinated_timing(width, height, 60.0, true));
  constexpr std::array<double, 4> kRates{85.0, 75.0, 60.0, 50.0};
  for (std::size_t bit = 0; bit < kRates.size(); ++bit) {
    if ((code[2] >> (bit + 1) & 1) != 0) list->add(coordinated_timing(width, height, kRates[bit], false));
  }
}

void add_descriptor(Bytes d, int revision, TimingList* list) {
  constexpr std::uint8_t kStandard = 0xfa;
  constexpr std::uint8_t kCoordinated = 0xf8;
  constexpr std::uint8_t kEstablishedMore = 0xf7;
  if (d[0] != 0 || d[1] != 0 || d[2] != 0) return;
  if (d[3] == kStandard) {
    for (std::size_t i = 5; i + 1 < kEdidDescriptor - 1; i += 2) list->add(standard_timing(d[i], d[i + 1], revision));
  } else if (d[3] == kCoordinated) {
    for (std::size_t i = 6; i + 3 <= kEdidDescriptor; i += 3) {
      if (d[i] != 0 || d[i + 1] != 0 || d[i + 2] != 0) add_coordinated(d.subspan(i, 3), list);
    }
  } else if (d[3] == kEstablishedMore) {
    for (std::size_t bit = 0; bit < kEstablished3.size(); ++bit) {
      if ((d[6 + bit / 8] >> (7 - bit % 8) & 1) != 0) list->add(dmt_timing(kEstablished3[bit]));
    }
  }
}

void add_base(Bytes block, TimingList* list) {
  constexpr std::size_t kEstablishedAt = 35;
  constexpr std::size_t kStandardAt = 38;
  constexpr std::size_t kFeatures = 24;
  const int revision = block[19];
  // From version 1.3 on, the first timing always is the preferred one; before that, a bit decides.
  const bool has_preferred = revision >= 3 || (block[kFeatures] & 2) != 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Bytes descriptor = block.subspan(54 + i * kEdidDescriptor, kEdidDescriptor);
    list->add(detailed_timing(descriptor), i == 0 && has_preferred);
    add_descriptor(descriptor, revision, list);
  }
  for (std::size_t i = 0; i < 8; ++i)
    list->add(standard_timing(block[kStandardAt + 2 * i], block[kStandardAt + 2 * i + 1], revision));
  for (std::size_t bit = 0; bit < kEstablished.size(); ++bit) {
    if ((block[kEstablishedAt + bit / 8] >> (7 - bit % 8) & 1) != 0) list->add(dmt_timing(kEstablished[bit]));
  }
}

void add_hdmi(Bytes data, TimingList* list) {
  constexpr std::array<int, 5> kVics{0, 95, 94, 93, 98};  // HDMI 1.4, table 8-13.
  if (data.size() < 8 || data[0] != 0x03 || data[1] != 0x0c || data[2] != 0x00 || (data[7] & 0x20) == 0) return;
  const bool has_latency = (data[7] & 0x80) != 0;
  const bool has_interlaced_latency = (data[7] & 0x40) != 0;
  const std::size_t at = 8U + (has_latency ? 2U : 0U) + (has_interlaced_latency ? 2U : 0U) + 1U;
  if (at >= data.size()) return;
  const std::size_t count = data[at] >> 5;
  for (std::size_t i = at + 1; i < std::min(data.size(), at + 1 + count); ++i) {
    if (data[i] < kVics.size()) list->add(cta_timing(kVics[data[i]]));
  }
}

/// An extension of CTA-861: data blocks, then detailed timings.
void add_cta(Bytes block, TimingList* list) {
  constexpr int kVideo = 2;
  constexpr int kVendor = 3;
  const std::size_t timings_at = block[2];
  if (timings_at > kEdidBlock - 1) return;
  const std::size_t data_end = block[1] >= 3 && timings_at >= 4 ? timings_at : 4;
  for (std::size_t at = 4; at < data_end;) {
    const int tag = block[at] >> 5;
    const std::size_t length = std::min<std::size_t>(block[at] & 31U, data_end - at - 1);
    const Bytes data = block.subspan(at + 1, length);
    if (tag == kVideo) {
      // Bit 7 marks a native format for the first 64 codes.
      for (const std::uint8_t code : data) list->add(cta_timing(code > 128 && code <= 192 ? code & 127 : code));
    } else if (tag == kVendor) {
      add_hdmi(data, list);
    }
    at += 1 + length;
  }
  for (std::size_t at = timings_at; at >= 4 && at + kEdidDescriptor < kEdidBlock; at += kEdidDescriptor) {
    const auto timing = detailed_timing(block.subspan(at, kEdidDescriptor));
    if (!timing) break;
    list->add(timing);
  }
}

/// Parses a detailed timing of DisplayID: type I (`clock_unit_khz` 10) or VII (1).
VideoTiming displayid_timing(Bytes d, int clock_unit_khz) {
  const auto u16 = [&](std::size_t at) { return (d[at] | d[at + 1] << 8) + 1; };
  const auto u15 = [&](std::size_t at) { return (d[at] | (d[at + 1] & 0x7f) << 8) + 1; };
  VideoTiming timing;
  timing.clock_khz = ((d[0] | d[1] << 8 | d[2] << 16) + 1) * clock_unit_khz;
  const auto axis = [&](std::size_t at) {
    const int front = u15(at + 4);
    const int sync = u16(at + 6);
    return TimingAxis{u16(at), front, sync, std::max(0, u16(at + 2) - front - sync), (d[at + 5] & 0x80) != 0};
  };
  timing.horizontal = axis(4);
  timing.vertical = axis(12);
  timing.is_interlaced = (d[3] & 0x10) != 0;
  return timing;
}

void add_displayid(Bytes block, TimingList* list) {
  constexpr std::uint8_t kType1 = 0x03;
  constexpr std::uint8_t kType7 = 0x22;
  constexpr std::size_t kTiming = 20;
  const std::size_t end = std::min<std::size_t>(5U + block[2], kEdidBlock - 1);
  for (std::size_t at = 5; at + 3 <= end;) {
    const std::size_t length = std::min<std::size_t>(block[at + 2], end - at - 3);
    const bool has_timings = block[at] == kType1 || block[at] == kType7;
    for (std::size_t i = 0; has_timings && i + kTiming <= length; i += kTiming) {
      const Bytes d = block.subspan(at + 3 + i, kTiming);
      list->add(displayid_timing(d, block[at] == kType1 ? 10 : 1), (d[3] & 0x80) != 0);
    }
    at += 3 + length;
  }
}

}  // namespace

std::vector<VideoTiming> edid_timings(Bytes bytes) {
  CHECK(bytes.size() >= kEdidBlock);
  constexpr std::uint8_t kCta = 0x02;
  constexpr std::uint8_t kDisplayId = 0x70;
  TimingList list;
  add_base(bytes.first(kEdidBlock), &list);
  for (std::size_t at = kEdidBlock; at + kEdidBlock <= bytes.size(); at += kEdidBlock) {
    const Bytes block = bytes.subspan(at, kEdidBlock);
    const unsigned sum = std::accumulate(block.begin(), block.end(), 0U) & 0xff;
    if (sum != 0) continue;
    if (block[0] == kCta) add_cta(block, &list);
    if (block[0] == kDisplayId) add_displayid(block, &list);
  }
  return list.take();
}

}  // namespace cyclorama
