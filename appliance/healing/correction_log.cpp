// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/correction_log.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>
#include <ranges>
#include <sstream>
#include <vector>

#include "common/base/file.h"
#include "common/json/strict_json.h"

namespace cyclorama::healing {
namespace {

using Pose = RigidTransform<frame::Room, frame::Projector>;

constexpr const char* kFile = "corrections.log";
constexpr std::uintmax_t kMaxLogBytes = std::uintmax_t{1} << 20;
constexpr std::size_t kMaxProjectors = 64;
// Two poses are equal if the step between them (radians and metres) is shorter than this: above the log's rounding,
// below any correction.
constexpr double kSame = 1e-5;

std::string pose_json(const Pose& T) {
  const Eigen::Quaterniond& q = T.rotation();
  const Eigen::Vector3d& t = T.translation();
  return fmt::format(R"({{"rotation_wxyz": [{:.9f}, {:.9f}, {:.9f}, {:.9f}], "position_m": [{:.6f}, {:.6f}, {:.6f}]}})",
                     q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
}

Pose pose_of(StrictJson json) {
  const std::vector<double> q = json.numbers("rotation_wxyz", 4, 4);
  const std::vector<double> t = json.numbers("position_m", 3, 3);
  if (q.size() != 4 || t.size() != 3) return {};
  const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
  if (!(std::abs(turn.norm() - 1.0) < 1e-6)) {
    json.refuse("is no rotation");
    return {};
  }
  return {turn, {t[0], t[1], t[2]}};
}

bool is_time(const std::string& text) {
  return text.size() == 20 && text.find_first_not_of("0123456789-:TZ") == std::string::npos;
}

}  // namespace

std::optional<LoggedCorrection> parse_correction(std::string_view line) {
  const auto document = parse_document(line, kFile, "remove the line");
  if (!document) return std::nullopt;
  StrictJson::Mistakes mistakes("remove the line");
  StrictJson json(*document, &mistakes);
  LoggedCorrection read;
  read.at = json.text("at", 40);
  read.kind = json.text("kind", 40);
  read.projector = static_cast<std::size_t>(json.integer("projector", 1, kMaxProjectors)) - 1;
  read.moved_px = json.number("moved_px", 0.0, 1e9);
  read.sigma_px = json.number("sigma_px", 0.0, 1e9);
  read.before = pose_of(json.at("before"));
  read.after = pose_of(json.at("after"));
  json.refuse_other_keys();
  const bool is_kind = read.kind == "bump" || read.kind == "drift" || read.kind == "undone";
  if (mistakes.is_any || !is_kind || !is_time(read.at)) return std::nullopt;
  return read;
}

std::string correction_line(const LoggedCorrection& c) {
  return fmt::format(
      R"({{"at": "{}", "projector": {}, "kind": "{}", "moved_px": {:.3f}, "sigma_px": {:.3f}, "before": {}, "after": {}}})",
      c.at, c.projector + 1, c.kind, c.moved_px, c.sigma_px, pose_json(c.before), pose_json(c.after));
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

void log_corrections(const std::filesystem::path& folder, std::span<const LoggedCorrection> corrections) {
  if (corrections.empty()) return;
  const std::filesystem::path path = folder / kFile;
  std::error_code ignored;
  if (std::filesystem::file_size(path, ignored) > kMaxLogBytes && !ignored)
    std::filesystem::rename(path, folder / (std::string(kFile) + ".1"), ignored);
  std::FILE* const file = std::fopen(path.c_str(), "ae");
  if (file == nullptr) return;
  for (const LoggedCorrection& one : corrections) fmt::print(file, "{}\n", correction_line(one));
  std::fclose(file);
}

std::optional<LoggedCorrection> last_correction(const std::filesystem::path& folder, std::span<const Pose> applied) {
  const auto text = read_text_file(folder / kFile, 2 * kMaxLogBytes);
  if (!text) return std::nullopt;
  std::vector<std::string> lines;
  std::istringstream all(*text);
  for (std::string line; std::getline(all, line);) lines.push_back(std::move(line));
  for (const std::string& line : std::views::reverse(lines)) {
    const auto one = parse_correction(line);
    if (!one || one->kind == "undone" || one->projector >= applied.size()) continue;
    if (calibration::step_between(applied[one->projector], one->after).norm() < kSame) return one;
  }
  return std::nullopt;
}

}  // namespace cyclorama::healing
