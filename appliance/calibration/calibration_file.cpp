// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/calibration_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>

#include "common/base/file.h"
#include "common/image/pfm.h"

namespace cyclorama::calibration {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxNodes = std::size_t{1} << 22;
constexpr std::size_t kKept = 10;
constexpr const char* kFile = "calibration.json";
constexpr const char* kFolder = "calibrations";

std::size_t index_of(const MeasuredMap& map, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(map.cells_x + 1) + static_cast<std::size_t>(x);
}

Status write_map(const fs::path& folder, std::size_t number, const MeasuredMap& map) {
  RadianceImage directions(map.cells_x + 1, map.cells_y + 1);
  RadianceImage sigmas(map.cells_x + 1, map.cells_y + 1);
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      const std::size_t i = index_of(map, x, y);
      for (int c = 0; c < 3; ++c) {
        directions.at(x, y)[c] = static_cast<float>(map.directions[i][c]);
        sigmas.at(x, y)[c] = static_cast<float>(map.sigma_px[i]);
      }
    }
  }
  TRY(write_pfm(folder / fmt::format("{}.map.pfm", number), directions));
  return write_pfm(folder / fmt::format("{}.sigma.pfm", number), sigmas);
}

Status read_map(const fs::path& folder, std::size_t number, MeasuredMap* map) {
  const fs::path file = folder / fmt::format("{}.map.pfm", number);
  const fs::path sigma_file = folder / fmt::format("{}.sigma.pfm", number);
  TRY_ASSIGN(const RadianceImage directions, read_pfm(file, kMaxNodes));
  TRY_ASSIGN(const RadianceImage sigmas, read_pfm(sigma_file, kMaxNodes));
  for (const auto& [image, path] : {std::pair(&directions, file), std::pair(&sigmas, sigma_file)}) {
    if (image->width() == map->cells_x + 1 && image->height() == map->cells_y + 1) continue;
    return Error(ErrorCode::kBadData,
                 fmt::format("{}: {}x{} control points, where {}x{} are expected; calibrate again", path.string(),
                             image->width(), image->height(), map->cells_x + 1, map->cells_y + 1));
  }
  for (int y = 0; y <= map->cells_y; ++y) {
    for (int x = 0; x <= map->cells_x; ++x) {
      const float* const d = directions.at(x, y);
      Eigen::Vector3d direction(static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2]));
      auto sigma = static_cast<double>(sigmas.at(x, y)[0]);
      constexpr double kUnit = 1e-3;
      const bool is_none = std::isnan(d[0]) && std::isnan(d[1]) && std::isnan(d[2]);
      if (!is_none && (!(std::abs(direction.norm() - 1.0) < kUnit) || !(sigma >= 0.0) || !std::isfinite(sigma))) {
        return Error(ErrorCode::kBadData,
                     fmt::format("{}: control point {}, {} is no direction, or has no sigma; calibrate again",
                                 file.string(), x, y));
      }
      if (!is_none) direction.normalize();
      map->directions.push_back(direction);
      map->sigma_px.push_back(is_none ? std::numeric_limits<double>::infinity() : sigma);
    }
  }
  return Done{};
}

bool is_date(const std::string& date) {
  return !date.empty() && date.size() <= 40 && date.find_first_not_of("0123456789TZ-") == std::string::npos;
}

/// Removes unfinished calibrations. Failures are ignored, since remains are harmless.
void remove_unfinished(const fs::path& calibrations) {
  std::error_code error;
  std::vector<fs::path> unfinished;
  for (fs::directory_iterator at(calibrations, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (is_date(at->path().filename().string()) && !fs::exists(at->path() / kFile, ignored))
      unfinished.push_back(at->path());
  }
  for (const fs::path& folder : unfinished) fs::remove_all(folder, error);
}

Result<Calibration> read_from(const fs::path& folder, const fs::path& file) {
  TRY_ASSIGN(const std::string text, read_text_file(file, kMaxBytes));
  TRY_ASSIGN(Calibration calibration, parse_calibration(text, file.string()));
  const fs::path maps = folder / kFolder / calibration.date;
  for (std::size_t i = 0; i < calibration.projectors.size(); ++i)
    TRY(read_map(maps, i + 1, &calibration.projectors[i].map));
  return calibration;
}

}  // namespace

fs::path calibration_folder(const fs::path& folder, const std::string& date) { return folder / kFolder / date; }

Status save_calibration(const fs::path& folder, const Calibration& calibration,
                        std::span<const CalibratedColour> colours, std::span<const CalibrationPart> parts) {
  if (!is_date(calibration.date)) {
    return Error(ErrorCode::kInvalidArgument, "a calibration's date is as 2026-11-22T13-05-00Z; give it one");
  }
  for (const CalibrationPart& part : parts) {
    if (!part.file.empty() && part.file.front() != '.' && part.file.find('/') == std::string::npos) continue;
    return Error(ErrorCode::kInvalidArgument, fmt::format("'{}' is no name of a file; give another", part.file));
  }
  const fs::path own = folder / kFolder / calibration.date;
  std::error_code error;
  fs::create_directories(own.parent_path(), error);
  if (!error && !fs::create_directory(own, error) && !error) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("{}: there is a calibration of that date; give another", own.string()));
  }
  if (error) return Error(ErrorCode::kSystem, fmt::format("making '{}': {}", own.string(), error.message()));
  for (std::size_t i = 0; i < calibration.projectors.size(); ++i)
    TRY(write_map(own, i + 1, calibration.projectors[i].map));
  if (!colours.empty()) TRY(write_colours(own, colours));
  for (const CalibrationPart& part : parts) TRY(write_file_atomically(own / part.file, part.text));
  const std::string text = calibration_json(calibration);
  TRY(write_file_atomically(own / kFile, text));
  TRY(write_file_atomically(folder / kFile, text));
  remove_unfinished(folder / kFolder);
  const auto kept = kept_calibrations(folder);
  for (std::size_t i = kKept; i < kept.size(); ++i) {
    if (kept[i] != calibration.date)
      fs::remove_all(folder / kFolder / kept[i], error);  // It is harmless if old calibrations cannot be removed.
  }
  return Done{};
}

Result<Calibration> read_calibration(const fs::path& folder) { return read_from(folder, folder / kFile); }

std::vector<std::string> kept_calibrations(const fs::path& folder) {
  std::vector<std::string> dates;
  std::error_code error;
  for (fs::directory_iterator at(folder / kFolder, error), end; !error && at != end; at.increment(error)) {
    const std::string date = at->path().filename().string();
    std::error_code ignored;
    if (is_date(date) && fs::exists(at->path() / kFile, ignored)) dates.push_back(date);
  }
  std::sort(dates.rbegin(), dates.rend());
  return dates;
}

Status restore_calibration(const fs::path& folder, const std::string& date) {
  if (!is_date(date)) return Error(ErrorCode::kNotFound, "no calibration has such a date; see which are kept");
  const fs::path file = folder / kFolder / date / kFile;
  TRY_ASSIGN(const Calibration calibration, read_from(folder, file));
  if (calibration.date != date) {
    return Error(ErrorCode::kBadData,
                 fmt::format("{}: /date: is of another day than its folder; choose another", file.string()));
  }
  TRY_ASSIGN(const std::string text, read_text_file(file, kMaxBytes));
  return write_file_atomically(folder / kFile, text);
}

}  // namespace cyclorama::calibration
