// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/crew.h"

#include <algorithm>
#include <utility>

#include "common/base/check.h"
#include "common/base/clock.h"

namespace cyclorama::render {
namespace {

/// The picture that this thread computes; null if none.
thread_local Crew::Picture* current = nullptr;

int threads_or_all(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

Crew::Crew(int threads, const std::function<void()>& at_start) : threads_(threads_or_all(threads)), queue_(threads_) {
  for (int i = 1; i < threads_; ++i) workers_.emplace_back([this, at_start] { serve(at_start); });
}

Crew::~Crew() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

Crew::Picture::Picture(Crew& crew, std::uint64_t order)
    : crew_(crew), outer_(current), lane_([&] {
        const std::lock_guard lock(crew.mutex_);
        return crew.queue_.open(order);
      }()) {
  CHECK(outer_ == nullptr || &outer_->crew_ != &crew);  // It would wait for the place that this thread already has.
  current = this;
  const std::lock_guard lock(crew.mutex_);
  if (crew.pictures_.size() <= lane_) crew.pictures_.resize(lane_ + 1);
  crew.pictures_[lane_] = this;
  began_seconds_ = crew.seconds_;
}

Crew::Picture::~Picture() {
  CHECK(current == this);
  current = outer_;
  const std::lock_guard lock(crew_.mutex_);
  crew_.queue_.close(lane_);
  crew_.pictures_[lane_] = nullptr;
  crew_.give_place();
}

void Crew::Picture::set_order(std::uint64_t order) {
  const std::lock_guard lock(crew_.mutex_);
  crew_.queue_.set_order(lane_, order);
}

double Crew::Picture::share() const {
  const std::lock_guard lock(crew_.mutex_);
  const double all = crew_.seconds_ - began_seconds_;
  return all > 0.0 ? seconds_ / all : 1.0;
}

void Crew::run(int count, const std::function<void(int)>& work) {
  if (count <= 0) return;
  if (current != nullptr && &current->crew_ == this) return run(*current, count, work);
  Picture picture(*this, 0);
  run(picture, count, work);
}

void Crew::run(Picture& picture, int count, const std::function<void(int)>& work) {
  std::unique_lock lock(mutex_);
  CHECK(picture.work_ == nullptr);  // Cells must not begin steps.
  picture.work_ = &work;
  picture.failure_ = nullptr;
  queue_.begin(picture.lane_, count);
  if (count > 1) changed_.notify_all();
  while (!queue_.is_complete(picture.lane_)) {
    if (const auto cells = queue_.take(picture.lane_)) {
      compute(*cells, &lock);
    } else {
      give_place();
      picture.completed_.wait(lock);
    }
  }
  picture.work_ = nullptr;
  if (picture.failure_) std::rethrow_exception(std::exchange(picture.failure_, nullptr));
}

void Crew::give_place() {
  changed_.notify_one();
  // A picture's thread that found all places taken waits for cells, too.
  for (Picture* const picture : pictures_) {
    if (picture != nullptr) picture->completed_.notify_one();
  }
}

void Crew::serve(const std::function<void()>& at_start) {
  if (at_start) at_start();
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (const auto cells = queue_.take()) {
      compute(*cells, &lock);
    } else {
      changed_.wait(lock);
    }
  }
}

void Crew::compute(const CellQueue::Cells& cells, std::unique_lock<std::mutex>* lock) {
  Picture& picture = *pictures_[cells.lane];
  const std::function<void(int)>& work = *picture.work_;
  lock->unlock();
  const SteadyClock clock;
  const TimePoint start = clock.now();
  std::exception_ptr failure;
  try {
    for (int cell = cells.first; cell < cells.end; ++cell) work(cell);
  } catch (...) {
    failure = std::current_exception();
  }
  const double seconds = to_seconds(clock.now() - start);
  lock->lock();
  seconds_ += seconds;
  picture.seconds_ += seconds;
  if (failure) {
    picture.failure_ = failure;
    queue_.drop_rest(cells.lane);
  }
  if (queue_.finish(cells, seconds)) picture.completed_.notify_one();
}

}  // namespace cyclorama::render
