// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace cyclorama::render {

/// Decides which cells a free thread computes next. Cells are the pieces of one step of one picture, such as 16x16
/// pixels to be traced, or a strip to be filtered; a step begins when the one before it is complete.
///
///   lane 0, order 1   picture A   ▓▓▓▓▓▓▓▓▓▓▓▓▓░   all cells are taken, the last ones are still computed
///   lane 1, order 2   picture B   ▓▓▓▓░░░░░░░░░░   threads that find nothing in lane 0 are here
///   lane 2, order 3               (its picture is between two steps, on a thread of its own)
///
/// So threads wait for the last cell of a step only if no lane has cells, and the picture of the lowest order still
/// gets all threads that it can use. Crew runs it with threads, `./bench.sh node-threads` with simulated ones. Pure;
/// thread-bound.
class CellQueue {
 public:
  using Lane = std::size_t;
  /// Cells that a thread computes one after another: a few if they are short, so that threads rarely meet here.
  struct Cells {
    Lane lane = 0;
    int first = 0;
    int end = 0;
  };

  /// No more than `threads` threads work at once, except for a cell's time after a picture's own thread went on.
  explicit CellQueue(int threads) : threads_(threads) {}

  /// Returns an unused lane for a picture. Its thread counts as working except between begin() and the step's end.
  Lane open(std::uint64_t order);
  void close(Lane lane);
  /// Sets the order of a lane, also in the middle of a step. Lanes of the same order go by number.
  void set_order(Lane lane, std::uint64_t order) { lanes_[lane].order = order; }
  [[nodiscard]] std::uint64_t order(Lane lane) const { return lanes_[lane].order; }

  /// Begins a step of `count` cells, at least one. Precondition: the step before it is complete.
  void begin(Lane lane, int count);
  /// Takes cells of the lowest order for a thread without a picture. Returns nothing if there are none or enough threads
  /// work.
  std::optional<Cells> take();
  /// Takes cells for the thread of this lane's picture: its own, or those of a lower order. Returns nothing if there are
  /// none or enough threads work.
  std::optional<Cells> take(Lane lane);
  /// To be called when taken cells are computed. Returns true if this completes the lane's step.
  bool finish(const Cells& cells, double seconds);
  /// Drops the cells of a step that nobody has taken.
  void drop_rest(Lane lane);
  [[nodiscard]] bool is_complete(Lane lane) const;

 private:
  struct Step {
    bool is_open = false;
    bool is_running = false;  ///< In a step, whose cells count instead of the picture's own thread.
    std::uint64_t order = 0;
    int count = 0;
    int next = 0;
    int unfinished = 0;
    double seconds = 0.0;  ///< Time that the step's finished cells took.
    int finished = 0;
  };
  [[nodiscard]] int batch_of(const Step& step) const;
  /// Takes cells of the lowest order up to that of `last`, if there is one.
  std::optional<Cells> take_lowest(std::optional<Lane> last);

  const int threads_;
  int working_ = 0;  ///< Threads that compute cells, and those of pictures between two steps.
  std::vector<Step> lanes_;
};

}  // namespace cyclorama::render
