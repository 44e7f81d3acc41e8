// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cost_record.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "common/base/file.h"

namespace cyclorama::balance {
namespace {

// Numbers are copied in their memory representation.
static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMark = "CYCOST1\n";
constexpr int kMaxSidePx = 16384;
constexpr std::size_t kFixedBytes = 2 * sizeof(std::uint32_t) + 6 * sizeof(double);

bool is_work(float work) { return std::isfinite(work) && work >= 0.0f; }

/// Returns a description of the frame's defect; null if it has none.
const char* fault_of(const RecordedFrame& frame) {
  const PictureSize size = frame.work.size();
  if (size.width < 1 || size.height < 1 || size.width > kMaxSidePx || size.height > kMaxSidePx) {
    return "the picture is not 1 to 16384 pixels each way";
  }
  if (!std::isfinite(frame.heading_rad) || !std::ranges::all_of(frame.eye_m, [](double v) { return std::isfinite(v); }))
    return "heading or eye is not finite";
  if (!(frame.azimuth_span_rad >= 0.0 && std::isfinite(frame.azimuth_span_rad))) return "the azimuth span is below 0";
  if (!(frame.effort > 0.0 && std::isfinite(frame.effort))) return "the effort is not above 0";
  if (!std::ranges::all_of(frame.work.cells(), is_work)) return "a cell's work is not finite, or below 0";
  return nullptr;
}

/// Reads values from the front of a span. Precondition of take(): enough bytes are left.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : left_(bytes) {}
  template <typename T>
  T take() {
    T value;
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return value;
  }
  void take(std::span<float> ret) {
    std::memcpy(ret.data(), left_.data(), ret.size_bytes());
    left_ = left_.subspan(ret.size_bytes());
  }
  [[nodiscard]] std::size_t left() const { return left_.size(); }

 private:
  std::span<const std::byte> left_;
};

/// Parses a frame from `bytes`, which follow its length. Returns a description of its defect; nothing if it has none.
std::optional<const char*> parse_frame(std::span<const std::byte> bytes, RecordedFrame* ret) {
  if (bytes.size() < kFixedBytes) return "it is too short";
  Reader reader(bytes);
  const auto width = reader.take<std::uint32_t>();
  const auto height = reader.take<std::uint32_t>();
  if (width < 1 || height < 1 || width > kMaxSidePx || height > kMaxSidePx)
    return "the picture is not 1 to 16384 pixels each way";
  ret->heading_rad = reader.take<double>();
  ret->azimuth_span_rad = reader.take<double>();
  for (double& v : ret->eye_m) v = reader.take<double>();
  ret->effort = reader.take<double>();
  // The number of cells is checked before memory is allocated for them.
  const auto cells = static_cast<std::size_t>(cells_in(static_cast<int>(width))) *
                     static_cast<std::size_t>(cells_in(static_cast<int>(height)));
  if (reader.left() != cells * sizeof(float)) return "its length does not fit its picture";
  ret->work = WorkGrid({static_cast<int>(width), static_cast<int>(height)});
  reader.take(ret->work.cells());
  const char* const fault = fault_of(*ret);
  return fault == nullptr ? std::nullopt : std::optional(fault);
}

void append(std::vector<std::byte>* bytes, const void* from, std::size_t count) {
  const auto* const first = static_cast<const std::byte*>(from);
  bytes->insert(bytes->end(), first, first + count);
}
template <typename T>
void append(std::vector<std::byte>* bytes, T value) {
  append(bytes, &value, sizeof value);
}

}  // namespace

Result<std::vector<RecordedFrame>> parse_cost_record(std::span<const std::byte> bytes, std::string_view name) {
  if (bytes.size() < kMark.size() || std::memcmp(bytes.data(), kMark.data(), kMark.size()) != 0) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' is not a record of costs", name));
  }
  std::vector<RecordedFrame> frames;
  std::size_t at = kMark.size();
  while (bytes.size() - at >= sizeof(std::uint32_t)) {
    const std::size_t length = Reader(bytes.subspan(at)).take<std::uint32_t>();
    if (bytes.size() - at - sizeof(std::uint32_t) < length) break;
    RecordedFrame frame;
    if (const auto fault = parse_frame(bytes.subspan(at + sizeof(std::uint32_t), length), &frame)) {
      return Error(ErrorCode::kBadData, fmt::format("'{}', frame {} at byte {}: {}", name, frames.size(), at, *fault));
    }
    frames.push_back(std::move(frame));
    at += sizeof(std::uint32_t) + length;
  }
  return frames;
}

Result<std::vector<RecordedFrame>> read_cost_record(const std::filesystem::path& path) {
  TRY_ASSIGN(const std::vector<std::byte> bytes, read_file(path, kMaxRecordBytes));
  return parse_cost_record(bytes, path.string());
}

Result<CostRecorder> CostRecorder::create(const std::filesystem::path& path) {
  UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644));
  if (!fd.is_open() && errno == EEXIST) {
    return Error(ErrorCode::kBusy, fmt::format("'{}' exists: records are never overwritten", path.string()));
  }
  if (!fd.is_open()) return Error::from_errno(fmt::format("creating '{}'", path.string()));
  CostRecorder recorder(std::move(fd), path);
  TRY(recorder.write(std::as_bytes(std::span(kMark))));
  return recorder;
}

Status CostRecorder::add(const RecordedFrame& frame) {
  if (const char* const fault = fault_of(frame)) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("recording a frame in '{}': {}", path_.string(), fault));
  }
  const std::span<const float> cells = frame.work.cells();
  const std::size_t length = kFixedBytes + cells.size_bytes();
  if (written_ + sizeof(std::uint32_t) + length > kMaxRecordBytes) {
    return Error(ErrorCode::kUnavailable, fmt::format("'{}' is full: {} bytes", path_.string(), written_));
  }
  std::vector<std::byte> bytes;
  bytes.reserve(sizeof(std::uint32_t) + length);
  append(&bytes, static_cast<std::uint32_t>(length));
  append(&bytes, static_cast<std::uint32_t>(frame.work.size().width));
  append(&bytes, static_cast<std::uint32_t>(frame.work.size().height));
  append(&bytes, frame.heading_rad);
  append(&bytes, frame.azimuth_span_rad);
  for (const double v : frame.eye_m) append(&bytes, v);
  append(&bytes, frame.effort);
  append(&bytes, cells.data(), cells.size_bytes());
  return write(bytes);
}

Status CostRecorder::add(const RecordedFrame& frame_without_work, PictureSize size,
                         std::span<const MeasuredBlock> blocks) {
  RecordedFrame frame = frame_without_work;
  frame.work = work_of(size, blocks, CellTimes::kMeasured, nullptr);
  for (float& work : frame.work.cells()) {
    if (!is_work(work)) work = 0.0f;
  }
  return add(frame);
}

Status CostRecorder::write(std::span<const std::byte> bytes) {
  ssize_t n = 0;
  do {
    n = ::write(fd_.get(), bytes.data(), bytes.size());
  } while (n < 0 && errno == EINTR);
  if (n < 0) return Error::from_errno(fmt::format("writing '{}'", path_.string()));
  if (static_cast<std::size_t>(n) == bytes.size()) {
    written_ += bytes.size();
    return Done{};
  }
  // A partial frame would make everything after it unreadable.
  if (::ftruncate(fd_.get(), static_cast<off_t>(written_)) != 0) {
    return Error::from_errno(fmt::format("removing half a frame from '{}'", path_.string()));
  }
  return Error(ErrorCode::kSystem, fmt::format("writing '{}': the disk took only a part", path_.string()));
}

}  // namespace cyclorama::balance
