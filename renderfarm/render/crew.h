// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "renderfarm/render/cell_queue.h"

namespace cyclorama::render {

/// Threads that compute the cells of one or several pictures at once, in the order of CellQueue. Thread-safe.
class Crew {
 public:
  /// `threads` threads work at once (0: one per core). All but one are started here and begin with `at_start` (may be
  /// null); the threads that call run() work, too.
  explicit Crew(int threads, const std::function<void()>& at_start = nullptr);
  virtual ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  [[nodiscard]] int threads() const { return threads_; }
  /// Calls `work` with 0 to `count` - 1, each once, from any thread, and returns when all calls have returned. If none
  /// of its cells is left, this thread computes cells of pictures of lower order. Throws what a call threw; cells that
  /// were not begun by then are left out.
  virtual void run(int count, const std::function<void(int)>& work);

  /// A picture that the calling thread computes: its run() has this order among the crew's pictures. Without one, each
  /// run() has order 0. Its order may be set from any thread; else thread-bound.
  class Picture {
   public:
    /// Precondition: the thread has no other picture of this crew.
    Picture(Crew& crew, std::uint64_t order);
    ~Picture();
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;
    void set_order(std::uint64_t order);
    /// Returns the share of this picture in what the crew computed since it began; 1 if that was nothing.
    [[nodiscard]] double share() const;

   private:
    friend class Crew;
    Crew& crew_;
    Picture* const outer_;  ///< The thread's picture before this one; null if there was none.
    const CellQueue::Lane lane_;
    std::condition_variable completed_;
    const std::function<void(int)>* work_ = nullptr;  ///< Null between two steps. The crew's mutex guards it.
    std::exception_ptr failure_;                      ///< Exception of a cell of the step. The crew's mutex guards it.
    double began_seconds_ = 0.0;                      ///< Crew::seconds_ when it began.
    double seconds_ = 0.0;                            ///< Time of its cells. The crew's mutex guards it.
  };

 protected:
  /// For a crew that has no threads of its own and overrides run().
  struct WithoutThreads {};
  Crew(WithoutThreads /*none*/, int threads) : threads_(threads), queue_(threads) {}

 private:
  void serve(const std::function<void()>& at_start);
  /// Wakes the threads that may take the place of one that stopped working. Precondition: the mutex is held.
  void give_place();
  void compute(const CellQueue::Cells& cells, std::unique_lock<std::mutex>* lock);
  void run(Picture& picture, int count, const std::function<void(int)>& work);

  const int threads_;
  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  CellQueue queue_;
  std::vector<Picture*> pictures_;  ///< Indexed by lane.
  double seconds_ = 0.0;            ///< Time of all cells so far.
  bool stopping_ = false;

  std::vector<std::thread> workers_;
};

}  // namespace cyclorama::render
