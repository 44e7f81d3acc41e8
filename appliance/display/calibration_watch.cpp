// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/calibration_watch.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/stat.h>

#include <utility>

#include "appliance/calibration/calibration_file.h"
#include "appliance/calibration/show_file.h"
#include "common/base/file.h"

namespace cyclorama::display {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(250);
constexpr const char* kFile = "calibration.json";
constexpr std::size_t kMaxBytes = std::size_t{16} << 20;

std::string mark_of(const std::filesystem::path& file) {
  struct stat info {};
  if (::stat(file.c_str(), &info) != 0) return "none;";
  return fmt::format("{}:{}:{}.{:09};", info.st_ino, info.st_size, info.st_mtim.tv_sec, info.st_mtim.tv_nsec);
}

}  // namespace

CalibrationWatch::CalibrationWatch(std::filesystem::path folder, Installation installation, PictureShape picture,
                                   std::vector<HeadPlan> planned)
    : folder_(std::move(folder)),
      installation_(std::move(installation)),
      picture_(std::move(picture)),
      planned_(std::move(planned)) {}

std::string CalibrationWatch::mark() const {
  return mark_of(folder_ / kFile) + mark_of(folder_ / calibration::kCorrectionFile) +
         (colours_folder_.empty() ? "" : mark_of(colours_folder_ / "colours.json"));
}

/// Must be called before other files are read, so that a change in the meantime triggers another read.
void CalibrationWatch::find_colours() {
  colours_folder_.clear();
  const auto text = read_text_file(folder_ / kFile, kMaxBytes);
  const auto calibration =
      text ? calibration::parse_calibration(*text, kFile) : Result<calibration::Calibration>(text.error());
  if (calibration) colours_folder_ = calibration::calibration_folder(folder_, calibration->date);
}

Result<CalibratedHeads> CalibrationWatch::read() {
  const std::string file_mark = mark_of(folder_ / kFile) + mark_of(folder_ / calibration::kCorrectionFile);
  find_colours();
  mark_ = file_mark + (colours_folder_.empty() ? "" : mark_of(colours_folder_ / "colours.json"));
  return calibrated_heads(folder_, installation_, picture_, planned_);
}

void CalibrationWatch::run() {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    pthread_setname_np(pthread_self(), "calibration");
    look_until(stop);
  });
}

void CalibrationWatch::look_until(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    woken_.wait_for(lock, stop, kBetweenLooks, [] { return false; });
    if (stop.stop_requested() || mark() == mark_) continue;
    auto heads = read();
    auto news = std::make_unique<CalibrationUpdate>();
    if (heads) {
      news->date = std::move(heads->date);
      news->lacking = std::move(heads->lacking);
      news->corrected = std::move(heads->corrected);
      for (const HeadPlan& head : heads->heads) news->footprints.emplace_back(head.warp, head.mask);
      news->set = std::make_unique<HeadSet>(std::make_shared<const std::vector<HeadPlan>>(std::move(heads->heads)));
    } else {
      news->trouble = std::move(heads).error();
    }
    news_.put(std::move(news));
  }
}

}  // namespace cyclorama::display
