// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "common/base/clock.h"
#include "renderfarm/generator/grotto.h"

namespace cyclorama::generator {
namespace {

constexpr auto kPollPeriod = std::chrono::milliseconds(100);

/// Distributes parts, largest first, among the threads. Each file is written by one thread, in a fixed order.
class Workshop {
 public:
  Workshop(const Grotto& grotto, GeometrySink& sink) : sink_(sink), all_(grotto.counts().triangles) {
    for (const Part& part : grotto.parts) queue_.push_back(&part);
    std::stable_sort(queue_.begin(), queue_.end(),
                     [](const Part* a, const Part* b) { return a->counts().triangles > b->counts().triangles; });
  }

  void work() {
    while (!stop_.load(std::memory_order_relaxed)) {
      const std::size_t i = next_.fetch_add(1);
      if (i >= queue_.size()) break;
      if (const Status status = make(*queue_[i]); !status) fail(status.error());
    }
  }

  void leave() {
    const std::lock_guard lock(mutex_);
    ++gone_;
    changed_.notify_all();
  }

  /// Reports progress until `threads` threads have finished.
  void watch(int threads, const KeepGoing& keep_going) {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, kPollPeriod, [&] { return gone_ == threads; })) {
      lock.unlock();
      const double fraction = static_cast<double>(done_.load(std::memory_order_relaxed)) / static_cast<double>(all_);
      if (!keep_going(fraction)) stop_.store(true, std::memory_order_relaxed);
      lock.lock();
    }
  }

  [[nodiscard]] Status outcome() {
    const std::lock_guard lock(mutex_);
    if (error_) return *error_;
    if (stop_.load(std::memory_order_relaxed))
      return Error(ErrorCode::kUnavailable, "stopped before the grotto was complete");
    return Done{};
  }

 private:
  Status make(const Part& part) {
    TRY_ASSIGN(const auto file, sink_.open(part.file, part.counts()));
    return write_part(part, *file, [this](std::uint64_t triangles) {
      done_.fetch_add(triangles, std::memory_order_relaxed);
      return !stop_.load(std::memory_order_relaxed);
    });
  }

  /// Stops all threads. Keeps only the first error, because the others follow from it.
  void fail(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (!error_ && !stop_.load(std::memory_order_relaxed)) error_ = error;
    stop_.store(true, std::memory_order_relaxed);
  }

  GeometrySink& sink_;
  std::vector<const Part*> queue_;
  std::uint64_t all_;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::uint64_t> done_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  int gone_ = 0;                ///< Guarded by mutex_.
  std::optional<Error> error_;  ///< Guarded by mutex_.
};

}  // namespace

Status generate(const Grotto& grotto, GeometrySink& sink, int threads, const KeepGoing& keep_going) {
  CHECK(threads >= 1);
  Workshop workshop(grotto, sink);
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < threads; ++i) {
      workers.emplace_back([&workshop] {
        workshop.work();
        workshop.leave();
      });
    }
    workshop.watch(threads, keep_going);
  }
  TRY(workshop.outcome());
  keep_going(1.0);
  return Done{};
}

}  // namespace cyclorama::generator
