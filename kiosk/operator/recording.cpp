// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/recording.h"

#include <algorithm>
#include <span>

#include "common/image/image_file.h"
#include "kiosk/operator/picture_check.h"

namespace cyclorama::operations {
namespace {
constexpr int kOverTimeWidthPx = 480;
constexpr std::size_t kMaxPictures = 64;
}  // namespace

Recording::Recording(std::vector<ProcessLink> links) : links_(std::move(links)), processes_(links_.size()) {
  for (std::size_t i = 0; i < links_.size(); ++i) processes_[i].last.endpoint = links_[i].endpoint();
}

void Recording::look(TimePoint now) {
  for (std::size_t i = 0; i < links_.size(); ++i) look_at(links_[i], &processes_[i], now);
}

void Recording::look_at(const ProcessLink& link, RecordedProcess* process, TimePoint now) {
  process->last = observe(link, process->last);
  if (process->last.away) {
    if (!process->away_since) process->away_since = now;
    if (process->answered) process->max_absence = std::max(process->max_absence, now - *process->away_since);
    return;
  }
  process->answered = true;
  process->away_since.reset();
  for (const std::string& name : process->last.status->pictures()) take_picture(link, name);
}

void Recording::take_picture(const ProcessLink& link, const std::string& name) {
  const std::string& process = link.endpoint().name;
  const auto named = pictures_.find(name);
  // The first process with a picture of this name uses the plain name as the key.
  const std::string key = named == pictures_.end() || named->second.process == process ? name : process + "/" + name;
  if (!pictures_.contains(key) && pictures_.size() >= kMaxPictures) return;
  RecordedPicture& picture = pictures_[key];
  picture.process = process;
  picture.name = name;
  const auto answer = link.picture(name);
  if (!answer) return;
  auto decoded = decoder_.decode(std::as_bytes(std::span(answer->jpeg())), kPhotoLimitPx);
  if (!decoded) return;
  picture.newest = *std::move(decoded);
  if (picture.first.empty()) picture.first = picture.newest;
  picture.max_changed = std::max(picture.max_changed, changed_share(picture.first, picture.newest));
}

void Recording::tick() {
  for (auto& [key, picture] : pictures_) picture.overtime.push_back(shrunk(picture.newest, kOverTimeWidthPx));
}

void Recording::begin() {
  for (RecordedProcess& process : processes_) process.max_absence = {};
  for (auto& [key, picture] : pictures_) {
    picture.first = picture.newest;
    picture.max_changed = 0.0;
  }
}

const wire::ProcessStatus* Recording::status_of(std::string_view name) const {
  for (const RecordedProcess& process : processes_) {
    if (process.last.endpoint.name == name && process.last.status) return &*process.last.status;
  }
  return nullptr;
}

double Recording::gauge(std::string_view process, std::string_view name) const {
  const wire::ProcessStatus* const status = status_of(process);
  return status == nullptr ? 0.0 : gauge_of(*status, name).value_or(0.0);
}

double Recording::frames() const { return gauge("tour", "frames"); }

double Recording::poses() const { return gauge("display", "poses_shown"); }

}  // namespace cyclorama::operations
