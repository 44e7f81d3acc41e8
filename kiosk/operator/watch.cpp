// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/watch.h"

#include <fmt/format.h>

namespace cyclorama::operations {
namespace {
constexpr auto kBetweenQuestions = std::chrono::milliseconds(500);
constexpr auto kPictureFresh = std::chrono::milliseconds(90);
constexpr std::size_t kMaxPictures = 64;
}  // namespace

Watch::Watch(std::vector<ProcessLink> links) : links_(std::move(links)) {
  for (const ProcessLink& link : links_) {
    ProcessObservation unknown;
    unknown.endpoint = link.endpoint();
    unknown.sentence = "It has not been queried yet.";
    observations_.push_back(std::move(unknown));
  }
  for (std::size_t i = 0; i < links_.size(); ++i) threads_.emplace_back([this, i] { look(i); });
}

Watch::~Watch() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Watch::look(std::size_t index) {
  ProcessObservation last;
  for (;;) {
    last = observe(links_[index], last);
    std::unique_lock lock(mutex_);
    observations_[index] = last;
    if (changed_.wait_for(lock, kBetweenQuestions, [this] { return stopping_; })) return;
  }
}

std::vector<ProcessObservation> Watch::observations() const {
  const std::lock_guard lock(mutex_);
  return observations_;
}

const ProcessLink* Watch::find(const std::string& process) const {
  for (const ProcessLink& link : links_) {
    if (link.endpoint().name == process) return &link;
  }
  return nullptr;
}

bool Watch::Shown::serves(TimePoint now) const {
  if (answer.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  return answer.get() && now - asked_at < kPictureFresh;
}

Result<std::shared_ptr<const wire::Picture>> Watch::picture(const std::string& process, const std::string& name) {
  const ProcessLink* const link = find(process);
  if (link == nullptr) return Error(ErrorCode::kNotFound, fmt::format("no process '{}' is watched", process));
  const std::string key = process + ' ' + name;
  std::promise<Picture> promise;
  {
    const TimePoint now = SteadyClock().now();
    std::unique_lock lock(mutex_);
    const auto shown = pictures_.find(key);
    if (shown != pictures_.end() && shown->second.serves(now)) {
      const std::shared_future<Picture> answer = shown->second.answer;
      lock.unlock();
      return answer.get();
    }
    if (pictures_.size() >= kMaxPictures) pictures_.clear();
    pictures_[key] = {promise.get_future().share(), now};
  }
  const auto ask = [&]() -> Picture {
    TRY_ASSIGN(wire::Picture picture, link->picture(name));
    return std::make_shared<const wire::Picture>(std::move(picture));
  };
  Picture answer = ask();
  promise.set_value(answer);
  return answer;
}

Status Watch::steer(const wire::SteerRequest& request) const {
  const ProcessLink* const tour = find("tour");
  if (tour == nullptr) return Error(ErrorCode::kNotFound, "no process 'tour' is watched");
  return tour->steer(request);
}

}  // namespace cyclorama::operations
