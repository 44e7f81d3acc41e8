// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_worker.h"

#include <algorithm>
#include <utility>

namespace cyclorama::node {
namespace {

/// Interval at which a computation is checked.
constexpr Duration kPeriod = std::chrono::milliseconds(20);
/// Share below which the remaining time is unknown.
constexpr double kMinShare = 0.02;

}  // namespace

LightWorker::LightWorker(LightStarter starter, LightFiles files, Calls calls, const Clock& clock)
    : starter_(std::move(starter)), files_(std::move(files)), calls_(std::move(calls)), clock_(clock) {}

void LightWorker::want(const std::string& path, const std::string& name) {
  if (!starter_) return;
  {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(waiting_, path, &Wanted::path) != waiting_.end()) return;
    waiting_.push_back({path, name});
  }
  changed_.notify_all();
}

void LightWorker::forget(const std::string& path) {
  const std::lock_guard lock(mutex_);
  for (Wanted& wanted : waiting_) wanted.is_forgotten |= wanted.path == path;
}

const LightWorker::Stage* LightWorker::find_stage(const std::string& path, const wire::LightStage& stage) const {
  if (current_ == nullptr || waiting_.empty() || waiting_.front().path != path) return nullptr;
  const auto found = stages_.find(stage.number());
  return found == stages_.end() || found->second.begun.key != stage.key() ? nullptr : &found->second;
}

void LightWorker::compute(const std::string& path, const wire::ComputePieces& order) {
  const std::lock_guard lock(mutex_);
  if (find_stage(path, order.stage()) == nullptr) return;
  for (const std::uint32_t piece : order.pieces()) current_->compute(order.stage().number(), piece);
}

void LightWorker::set_stage(const BegunStage& stage, wire::LightStage* to) {
  to->set_number(stage.number);
  to->set_key(stage.key);
  to->set_pieces(stage.pieces);
}

std::optional<wire::LightPieces> LightWorker::stage_of(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  if (current_ == nullptr || waiting_.empty() || waiting_.front().path != path || stages_.empty()) return std::nullopt;
  const Stage& stage = stages_.rbegin()->second;
  wire::LightPieces report;
  set_stage(stage.begun, report.mutable_stage());
  for (const auto& [piece, file] : stage.taken) {
    wire::LightPiece& taken = *report.add_pieces();
    taken.set_piece(piece);
    *taken.mutable_file() = file;
  }
  return report;
}

std::filesystem::path LightWorker::piece_file(const std::string& path, const wire::LightStage& stage,
                                              std::uint32_t piece) const {
  const std::lock_guard lock(mutex_);
  const Stage* const found = find_stage(path, stage);
  if (found == nullptr || piece >= found->begun.pieces) return {};
  return found->begun.folder / (std::to_string(stage.number()) + "-" + std::to_string(piece));
}

void LightWorker::fetched(const std::string& path, const wire::LightStage& stage, std::uint32_t piece) {
  const std::lock_guard lock(mutex_);
  if (find_stage(path, stage) != nullptr) current_->fetched(stage.number(), piece);
}

void LightWorker::follow(const std::string& path, const std::vector<LightEvent>& events) {
  std::vector<wire::LightPieces> reports;
  {
    const std::lock_guard lock(mutex_);
    for (const LightEvent& event : events) {
      if (const auto* const begun = std::get_if<BegunStage>(&event)) {
        stages_[begun->number] = {*begun};
        set_stage(*begun, reports.emplace_back().mutable_stage());
        continue;
      }
      const auto& taken = std::get<TakenPiece>(event);
      const auto stage = stages_.find(taken.stage);
      if (stage == stages_.end()) continue;
      wire::LightVersion& file = stage->second.taken[taken.piece];
      file.set_version(taken.sha256);
      file.set_bytes(taken.bytes);
      if (reports.empty()) set_stage(stage->second.begun, reports.emplace_back().mutable_stage());
      wire::LightPiece& piece = *reports.back().add_pieces();
      piece.set_piece(taken.piece);
      *piece.mutable_file() = file;
    }
  }
  for (const wire::LightPieces& report : reports) calls_.progressed(path, report);
}

void LightWorker::end_current() {
  current_ = nullptr;
  stages_.clear();
  waiting_.pop_front();
}

void LightWorker::give_way() {
  const std::lock_guard lock(mutex_);
  block_at_ = clock_.now();
  if (current_ == nullptr || paused_) return;
  current_->pause();
  paused_ = true;
}

void LightWorker::report(wire::NodeStatus* status) const {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    wire::LightProgress& progress = *status->add_light();
    progress.set_scene(waiting_[i].name);
    if (i > 0 || current_ == nullptr) continue;
    progress.set_done_share(done_share_);
    if (done_share_ >= kMinShare) progress.set_seconds_left(worked_seconds_ * (1.0 - done_share_) / done_share_);
  }
}

void LightWorker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
}

bool LightWorker::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
  if (!stopping_) changed_.wait_for(lock, kPeriod, [this] { return stopping_; });
  if (stopping_) current_ = nullptr;
  return !stopping_;
}

bool LightWorker::is_quiet() const { return block_at_ == TimePoint::min() || clock_.now() - block_at_ >= kQuiet; }

bool LightWorker::work() {
  const bool has_blocks = calls_.has_blocks();
  std::shared_ptr<LightComputation> current;
  Wanted wanted;
  bool may_begin = false;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return false;
    wanted = waiting_.front();
    if (has_blocks) block_at_ = clock_.now();
    current = current_;
    may_begin = is_quiet();
    const TimePoint now = clock_.now();
    if (current != nullptr && !paused_) worked_seconds_ += to_seconds(now - looked_at_);
    looked_at_ = now;
    if (current != nullptr && paused_ && may_begin) {
      current->resume();
      paused_ = false;
    }
  }
  if (wanted.is_forgotten || !calls_.is_wanted(wanted.path)) {
    current = nullptr;
    std::filesystem::path pieces;
    {
      const std::lock_guard lock(mutex_);
      if (wanted.is_forgotten && !stages_.empty()) pieces = stages_.begin()->second.begun.folder;
      end_current();
    }
    std::error_code none;
    if (!pieces.empty()) std::filesystem::remove_all(pieces, none);  // Whole light has come; they are of no more use.
    return true;
  }
  if (current == nullptr) {
    if (may_begin) begin(wanted);
    return true;
  }
  const double done_share = current->done_share();
  const std::optional<Status> result = current->result();
  follow(wanted.path, current->events());
  {
    const std::lock_guard lock(mutex_);
    done_share_ = done_share;
    if (!result) return true;
    end_current();
  }
  calls_.finished(wanted.path, file_, *result);
  return true;
}

void LightWorker::begin(const Wanted& wanted) {
  Status fine = Done{};
  std::shared_ptr<LightComputation> started;
  if (auto file = files_.prepare(wanted.path)) {
    file_ = *std::move(file);
    LightFiles::remove_left_over(file_);
    if (auto computation = starter_(wanted.path, file_)) {
      started = *std::move(computation);
    } else {
      fine = computation.error();
    }
  } else {
    fine = file.error();
  }
  {
    const std::lock_guard lock(mutex_);
    current_ = started;
    stages_.clear();
    paused_ = false;
    done_share_ = 0.0;
    worked_seconds_ = 0.0;
    if (started != nullptr && !is_quiet()) {  // A block has arrived meanwhile.
      started->pause();
      paused_ = true;
    }
    if (!fine) waiting_.pop_front();
  }
  if (!fine) calls_.finished(wanted.path, {}, fine);
}

}  // namespace cyclorama::node
