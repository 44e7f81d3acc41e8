// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/cell_queue.h"

#include <algorithm>

#include "common/base/check.h"

namespace cyclorama::render {
namespace {

/// A thread takes cells for about so long, in which it serves no other picture.
constexpr double kBatchSeconds = 0.0005;

}  // namespace

CellQueue::Lane CellQueue::open(std::uint64_t order) {
  auto lane = std::ranges::find(lanes_, false, &Step::is_open);
  if (lane == lanes_.end()) lane = lanes_.insert(lane, Step{});
  *lane = {.is_open = true, .order = order};
  ++working_;
  return static_cast<Lane>(lane - lanes_.begin());
}

void CellQueue::close(Lane lane) {
  CHECK(lanes_[lane].is_open && !lanes_[lane].is_running);
  lanes_[lane].is_open = false;
  --working_;
}

void CellQueue::begin(Lane lane, int count) {
  Step& step = lanes_[lane];
  CHECK(step.is_open && !step.is_running && count > 0);
  step = {.is_open = true, .is_running = true, .order = step.order, .count = count, .unfinished = count};
  --working_;
}

int CellQueue::batch_of(const Step& step) const {
  const int left = step.count - step.next;
  // Towards the end of a step batches become small, so that no thread is left with many cells while others have none.
  const int fair = left / (4 * threads_);
  if (fair <= 1 || step.finished == 0) return 1;
  const double mean = step.seconds / step.finished;
  const double fitting = mean > 0.0 ? kBatchSeconds / mean : static_cast<double>(fair);
  return std::clamp(static_cast<int>(std::min(fitting, 1e6)), 1, fair);
}

std::optional<CellQueue::Cells> CellQueue::take() {
  return working_ < threads_ ? take_lowest(std::nullopt) : std::nullopt;
}

std::optional<CellQueue::Cells> CellQueue::take(Lane lane) {
  return working_ < threads_ ? take_lowest(lane) : std::nullopt;
}

std::optional<CellQueue::Cells> CellQueue::take_lowest(std::optional<Lane> last) {
  std::optional<Lane> best;
  for (Lane lane = 0; lane < lanes_.size(); ++lane) {
    const Step& step = lanes_[lane];
    if (!step.is_running || step.next == step.count) continue;
    if (last && lane != *last && step.order >= lanes_[*last].order) continue;
    if (!best || step.order < lanes_[*best].order) best = lane;
  }
  if (!best) return std::nullopt;
  Step& step = lanes_[*best];
  const int first = step.next;
  step.next += batch_of(step);
  ++working_;
  return Cells{*best, first, step.next};
}

bool CellQueue::finish(const Cells& cells, double seconds) {
  Step& step = lanes_[cells.lane];
  const int count = cells.end - cells.first;
  --working_;
  step.seconds += seconds;
  step.finished += count;
  step.unfinished -= count;
  if (step.unfinished > 0) return false;
  step.is_running = false;
  ++working_;  // The picture's own thread goes on.
  return true;
}

void CellQueue::drop_rest(Lane lane) {
  Step& step = lanes_[lane];
  step.unfinished -= step.count - step.next;
  step.count = step.next;
}

bool CellQueue::is_complete(Lane lane) const { return !lanes_[lane].is_running; }

}  // namespace cyclorama::render
