// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "drivers/output/headless/headless_output.h"

namespace cyclorama {

/// Opens outputs in memory, which a test can make fail, and can prevent from being opened again. Thread-safe. Must
/// outlive its outputs.
class FakeOutputs {
 public:
  Result<std::unique_ptr<output::Output>> open(const output::HeadlessOptions& options, const Clock& clock) {
    ++attempts_;
    TRY(state());
    TRY_ASSIGN(std::unique_ptr<output::Output> real, output::open_headless_output(options, clock));
    return std::unique_ptr<output::Output>(std::make_unique<Losable>(*this, std::move(real)));
  }
  void lose() { is_lost_ = true; }
  void find() { is_lost_ = false; }
  [[nodiscard]] int attempts() const { return attempts_; }
  /// Simulates a graphics driver that never returns. Waits until a refresh hangs.
  void hang() {
    is_in_refresh_ = false;
    hangs_ = true;
    is_in_refresh_.wait(false);
  }
  void go_on() {
    hangs_ = false;
    hangs_.notify_all();
  }

 private:
  class Losable final : public output::Output {
   public:
    Losable(FakeOutputs& all, std::unique_ptr<output::Output> real) : all_(all), real_(std::move(real)) {}
    [[nodiscard]] const std::vector<output::HeadMode>& heads() const override { return real_->heads(); }
    [[nodiscard]] double refresh_hz() const override { return real_->refresh_hz(); }
    [[nodiscard]] std::string kind() const override { return real_->kind(); }
    [[nodiscard]] const output::Gl& gl() const override { return real_->gl(); }
    Status wait_for_refresh() override {
      if (all_.hangs_) {
        all_.is_in_refresh_ = true;
        all_.is_in_refresh_.notify_all();
        all_.hangs_.wait(true);
      }
      return real_->wait_for_refresh();
    }
    Status draw_to(std::size_t head) override { return real_->draw_to(head); }
    Result<output::Presented> present() override {
      TRY(all_.state());
      return real_->present();
    }

    [[nodiscard]] const std::vector<output::HeadShown>& shown() const override { return real_->shown(); }

   private:
    FakeOutputs& all_;
    std::unique_ptr<output::Output> real_;
  };

  [[nodiscard]] Status state() const {
    if (is_lost_) return Error(ErrorCode::kUnavailable, "the card was pulled out");
    return Done{};
  }
  std::atomic<bool> is_lost_{false};
  std::atomic<bool> hangs_{false};
  std::atomic<bool> is_in_refresh_{false};
  std::atomic<int> attempts_{0};
};

}  // namespace cyclorama
