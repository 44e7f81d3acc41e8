// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/show_record.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "appliance/calibration/show_file.h"
#include "common/base/check.h"

namespace cyclorama::healing {
namespace {

constexpr char kMagic[] = "CYCSHOW2";
constexpr std::size_t kMagicBytes = 8;
constexpr std::uint32_t kMaxJsonBytes = 1 << 20;
constexpr std::uint32_t kMaxPictures = 4096;
constexpr double kMaxDistanceM = 1e4;
constexpr std::uint32_t kMaxFactor = 16;
constexpr std::uint32_t kMaxSide_px = 16384;
constexpr std::size_t kMaxPicture_px = std::size_t{1} << 26;
enum : std::uint8_t { kMoment = 1, kRealignment = 2, kPutBack = 3 };
static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

template <typename Number>
void put_number(Number number, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&number), sizeof number);
}

calibration::ShowFile file_of(const calibration::ShowCalibration& show) {
  calibration::ShowFile file;
  file.calibration = "recorded";
  for (const calibration::ShowProjector& p : show.projectors)
    file.projectors.push_back({p.name, p.lens, p.T_room_projector, p.T_room_projector, {}, p.unplaced, p.light});
  for (const calibration::ShowCamera& c : show.cameras) file.cameras.push_back({c.name, c.lens, c.T_room_camera});
  return file;
}

Error system_error(const std::filesystem::path& path) {
  return Error::from_errno(fmt::format("writing '{}'", path.string()));
}

template <typename Number>
bool get(std::FILE* file, std::uintmax_t* left, Number* ret_number) {
  if (*left < sizeof *ret_number || std::fread(ret_number, sizeof *ret_number, 1, file) != 1) return false;
  *left -= sizeof *ret_number;
  return true;
}

bool get_bytes(std::FILE* file, std::uintmax_t* left, void* to, std::size_t count) {
  if (*left < count || std::fread(to, 1, count, file) != count) return false;
  *left -= count;
  return true;
}

std::string pose_text(const RigidTransform<frame::Room, frame::Projector>& T) {
  const Eigen::Quaterniond& q = T.rotation();
  const Eigen::Vector3d& t = T.translation();
  return fmt::format("{:a} {:a} {:a} {:a} {:a} {:a} {:a}", q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
}

}  // namespace

calibration::ShowCalibration show_of(const calibration::ShowFile& file, const Installation& installation) {
  calibration::ShowCalibration show;
  show.wall = installation.wall;
  show.sweet_spot = installation.sweet_spot;
  for (const calibration::ShowFile::Projector& p : file.projectors) {
    calibration::ShowProjector projector;
    projector.name = p.name;
    projector.lens = p.lens;
    projector.T_room_projector = p.applied;
    projector.light.fill(calibration::rounded_light(calibration::gamma_light(2.2)));
    if (p.light) projector.light = *p.light;
    projector.unplaced = p.unplaced;
    show.projectors.push_back(std::move(projector));
  }
  for (const calibration::ShowFile::Camera& c : file.cameras)
    show.cameras.push_back({c.name, c.lens, c.T_room_camera, calibration::gamma_light(1.0)});
  return show;
}

std::optional<LearnedRoom> learned_of(const calibration::ShowFile& file, const Installation& installation) {
  LearnedRoom learned{show_of(file, installation), {}, {}};
  for (std::size_t i = 0; i < file.projectors.size(); ++i) {
    const auto& one = file.projectors[i].learned;
    if (!one) return std::nullopt;
    learned.believed.projectors[i].T_room_projector = one->believed;
    learned.at_rest.push_back(one->at_rest);
    learned.roots.push_back(one->root);
  }
  for (const calibration::ShowFile::Camera& camera : file.cameras) {
    if (!camera.root) return std::nullopt;
    learned.roots.push_back(*camera.root);
  }
  return learned;
}

void put_learned(const LearnedRoom& learned, calibration::ShowFile* file) {
  const std::size_t count = file->projectors.size();
  CHECK(learned.at_rest.size() == count && learned.roots.size() == count + file->cameras.size());
  for (std::size_t i = 0; i < count; ++i) {
    file->projectors[i].learned = {learned.believed.projectors[i].T_room_projector, learned.at_rest[i],
                                   learned.roots[i]};
  }
  for (std::size_t i = 0; i < file->cameras.size(); ++i) file->cameras[i].root = learned.roots[count + i];
}

Result<ContinuousCalibrator> RecordStart::begin() const {
  ContinuousOptions options;
  options.pixels = factor;
  return learned ? ContinuousCalibrator::resume(applied, *learned, options)
                 : ContinuousCalibrator::make(applied, options);
}

std::string report_lines(const ShowReport& report) {
  std::string lines;
  for (const Correction& c : report.corrections) {
    lines += fmt::format("correction {} {} {:a} {:a} before {} after {}\n", c.projector, c.is_bump ? "bump" : "drift",
                         c.moved_px, c.sigma_px, pose_text(c.before), pose_text(c.after));
  }
  for (const std::size_t projector : report.noticed) lines += fmt::format("noticed {}\n", projector);
  for (const std::string& line : report.log) lines += line + "\n";
  return lines;
}

std::uintmax_t record_bytes(const std::filesystem::path& folder) {
  std::uintmax_t sum = 0;
  std::error_code failed;
  for (std::filesystem::recursive_directory_iterator it(folder, failed), end; !failed && it != end;
       it.increment(failed)) {
    std::error_code ignored;
    if (it->is_regular_file(ignored)) sum += it->file_size(ignored);
  }
  return sum;
}

Result<ShowRecorder> ShowRecorder::begin(const std::filesystem::path& folder, const std::filesystem::path& installation,
                                         const RecordStart& start, std::uintmax_t max_bytes) {
  if (std::holds_alternative<MeshWall>(start.applied.wall)) {
    return Error(ErrorCode::kInvalidArgument,
                 "a wall that is a mesh lies in other files and is not recorded; run without --record");
  }
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (!failed)
    std::filesystem::copy_file(installation, folder / "installation.toml",
                               std::filesystem::copy_options::overwrite_existing, failed);
  if (failed)
    return Error(ErrorCode::kSystem, fmt::format("recording into '{}': {}", folder.string(), failed.message()));
  File record(std::fopen((folder / "show.record").c_str(), "wbe"));
  File report(std::fopen((folder / "report.txt").c_str(), "wbe"));
  if (record == nullptr || report == nullptr) return system_error(folder);
  ShowRecorder recorder(std::move(record), std::move(report), max_bytes);
  std::string bytes(kMagic, kMagicBytes);
  put_number(start.factor, &bytes);
  std::string known;
  if (start.learned) {
    calibration::ShowFile file = file_of(start.learned->believed);
    put_learned(*start.learned, &file);
    known = calibration::show_json(file);
  }
  for (const std::string& json : {calibration::show_json(file_of(start.applied)), known}) {
    put_number(static_cast<std::uint32_t>(json.size()), &bytes);
    bytes += json;
  }
  TRY(recorder.put(bytes));
  return recorder;
}

Status ShowRecorder::put(const std::string& bytes) {
  if (bytes.size() > left_)
    return Error(ErrorCode::kBusy, "the record has reached its maximum size; no more is recorded");
  if (std::fwrite(bytes.data(), 1, bytes.size(), record_.get()) != bytes.size() || std::fflush(record_.get()) != 0)
    return system_error("show.record");
  left_ -= bytes.size();
  return Done{};
}

Status ShowRecorder::add(const ShowMoment& moment, const ShowReport& report) {
  std::string bytes;
  put_number(kMoment, &bytes);
  put_number(to_nanoseconds(moment.now), &bytes);
  const auto picture = [&](const auto& image) {
    put_number(static_cast<std::uint32_t>(image == nullptr ? 0 : image->width()), &bytes);
    put_number(static_cast<std::uint32_t>(image == nullptr ? 0 : image->height()), &bytes);
    if (image != nullptr) bytes.append(reinterpret_cast<const char*>(image->data().data()), image->data().size());
  };
  put_number(static_cast<std::uint32_t>(moment.shown.size()), &bytes);
  for (const ShownPicture& shown : moment.shown) {
    put_number(static_cast<std::uint32_t>(shown.projector), &bytes);
    put_number(to_nanoseconds(shown.lit_at), &bytes);
    put_number(shown.number, &bytes);
    picture(shown.picture);
  }
  put_number(static_cast<std::uint32_t>(moment.until.size()), &bytes);
  for (const ShownUntil& until : moment.until) {
    put_number(static_cast<std::uint32_t>(until.projector), &bytes);
    put_number(to_nanoseconds(until.at), &bytes);
    put_number(until.number, &bytes);
  }
  put_number(static_cast<std::uint32_t>(moment.seen.size()), &bytes);
  for (const CameraPicture& seen : moment.seen) {
    put_number(static_cast<std::uint32_t>(seen.camera), &bytes);
    put_number(to_nanoseconds(seen.opened), &bytes);
    put_number(to_nanoseconds(seen.closed), &bytes);
    picture(seen.picture);
  }
  TRY(put(bytes));
  const std::string lines = report_lines(report);
  if (std::fwrite(lines.data(), 1, lines.size(), report_.get()) != lines.size() || std::fflush(report_.get()) != 0)
    return system_error("report.txt");
  return Done{};
}

Status ShowRecorder::add_realignment() {
  std::string bytes;
  put_number(kRealignment, &bytes);
  return put(bytes);
}

Status ShowRecorder::add_put_back(std::size_t projector,
                                  const RigidTransform<frame::Room, frame::Projector>& T_room_projector) {
  std::string bytes;
  put_number(kPutBack, &bytes);
  put_number(static_cast<std::uint32_t>(projector), &bytes);
  const Eigen::Quaterniond& q = T_room_projector.rotation();
  const Eigen::Vector3d& t = T_room_projector.translation();
  for (const double value : {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) put_number(value, &bytes);
  return put(bytes);
}

Result<ShowRecord> ShowRecord::open(const std::filesystem::path& folder) {
  TRY_ASSIGN(const Installation installation, read_installation(folder / "installation.toml"));
  const std::filesystem::path path = folder / "show.record";
  std::error_code failed;
  std::uintmax_t left = std::filesystem::file_size(path, failed);
  File file(failed ? nullptr : std::fopen(path.c_str(), "rbe"));
  if (file == nullptr) return Error(ErrorCode::kNotFound, fmt::format("there is no record '{}'", path.string()));
  const Error no_record(ErrorCode::kBadData, fmt::format("'{}' is no record of a show", path.string()));
  char magic[kMagicBytes];
  if (!get_bytes(file.get(), &left, magic, sizeof magic) || std::memcmp(magic, kMagic, sizeof magic) != 0)
    return no_record;
  RecordStart start;
  if (!get(file.get(), &left, &start.factor) || start.factor < 1 || start.factor > kMaxFactor) return no_record;
  for (const bool is_learned : {false, true}) {
    std::uint32_t size = 0;
    if (!get(file.get(), &left, &size) || size > kMaxJsonBytes || size > left) return no_record;
    if (size == 0 && is_learned) break;
    std::string json(size, '\0');
    if (!get_bytes(file.get(), &left, json.data(), size)) return no_record;
    TRY_ASSIGN(const calibration::ShowFile show, calibration::parse_show(json, path.string()));
    if (is_learned) {
      start.learned = learned_of(show, installation);
      if (!start.learned) return no_record;
    } else {
      start.applied = show_of(show, installation);
    }
  }
  return ShowRecord(std::move(file), left, std::move(start));
}

Result<std::optional<ShowRecord::Event>> ShowRecord::next() {
  const Error damaged(ErrorCode::kBadData, "show.record is damaged");
  const std::optional<Event> end;
  std::FILE* const file = file_.get();
  std::uint8_t kind = 0;
  if (!get(file, &left_, &kind)) return end;
  Event event;
  if (kind == kRealignment) {
    event.wants_realignment = true;
    return std::optional<Event>(std::move(event));
  }
  if (kind == kPutBack) {
    std::uint32_t projector = 0;
    std::array<double, 7> v{};
    if (!get(file, &left_, &projector) || !get_bytes(file, &left_, v.data(), sizeof v)) return end;
    const Eigen::Quaterniond turn(v[0], v[1], v[2], v[3]);
    const Eigen::Vector3d position(v[4], v[5], v[6]);
    if (!(std::abs(turn.norm() - 1.0) < 1e-6) || !(position.norm() < kMaxDistanceM)) return damaged;
    event.put_back = projector;
    event.position = {turn, position};
    return std::optional<Event>(std::move(event));
  }
  if (kind != kMoment) return damaged;
  // Reads a picture. Returns nothing if the record is truncated, false if it is damaged.
  const auto picture = [&](auto* ret_image) -> std::optional<bool> {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    if (!get(file, &left_, &width) || !get(file, &left_, &height)) return std::nullopt;
    if (width > kMaxSide_px || height > kMaxSide_px || std::size_t{width} * height > kMaxPicture_px) return false;
    if (width == 0 || height == 0) return true;
    using ImageType = std::remove_const_t<typename std::remove_pointer_t<decltype(ret_image)>::element_type>;
    auto image = std::make_shared<ImageType>();
    // The size of the file is checked before memory is allocated.
    constexpr std::size_t kChannels = std::is_same_v<ImageType, RgbImage> ? 3 : 1;
    if (left_ < kChannels * width * height) return std::nullopt;
    *image = ImageType(static_cast<int>(width), static_cast<int>(height));
    if (!get_bytes(file, &left_, image->data().data(), image->data().size())) return std::nullopt;
    *ret_image = std::move(image);
    return true;
  };
  std::int64_t now_ns = 0;
  std::uint32_t count = 0;
  if (!get(file, &left_, &now_ns) || !get(file, &left_, &count)) return end;
  if (count > kMaxPictures) return damaged;
  event.moment.now = from_nanoseconds(now_ns);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t projector = 0;
    std::int64_t lit_ns = 0;
    std::uint64_t number = 0;
    if (!get(file, &left_, &projector) || !get(file, &left_, &lit_ns) || !get(file, &left_, &number)) return end;
    ShownPicture shown{projector, from_nanoseconds(lit_ns), nullptr, number};
    const auto read = picture(&shown.picture);
    if (!read) return end;
    if (!*read) return damaged;
    event.moment.shown.push_back(std::move(shown));
  }
  if (!get(file, &left_, &count)) return end;
  if (count > kMaxPictures) return damaged;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t projector = 0;
    std::int64_t at_ns = 0;
    std::uint64_t number = 0;
    if (!get(file, &left_, &projector) || !get(file, &left_, &at_ns) || !get(file, &left_, &number)) return end;
    event.moment.until.push_back({projector, from_nanoseconds(at_ns), number});
  }
  if (!get(file, &left_, &count)) return end;
  if (count > kMaxPictures) return damaged;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t camera = 0;
    std::int64_t opened_ns = 0;
    std::int64_t closed_ns = 0;
    if (!get(file, &left_, &camera) || !get(file, &left_, &opened_ns) || !get(file, &left_, &closed_ns)) return end;
    CameraPicture seen{camera, from_nanoseconds(opened_ns), from_nanoseconds(closed_ns), nullptr};
    const auto read = picture(&seen.picture);
    if (!read) return end;
    if (!*read) return damaged;
    event.moment.seen.push_back(std::move(seen));
  }
  return std::optional<Event>(std::move(event));
}

Result<std::string> replay(const std::filesystem::path& folder) {
  TRY_ASSIGN(ShowRecord record, ShowRecord::open(folder));
  TRY_ASSIGN(ContinuousCalibrator calibrator, record.start().begin());
  std::string lines;
  for (;;) {
    TRY_ASSIGN(const std::optional<ShowRecord::Event> event, record.next());
    if (!event) return lines;
    if (event->wants_realignment) {
      calibrator.realign();
    } else if (event->put_back) {
      if (*event->put_back >= calibrator.applied().projectors.size())
        return Error(ErrorCode::kBadData, fmt::format("'{}' is no record of a show", folder.string()));
      TRY(calibrator.put_back(*event->put_back, event->position));
    } else {
      lines += report_lines(calibrator.step(event->moment));
    }
  }
}

}  // namespace cyclorama::healing
