// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "renderfarm/node/light_computation.h"

namespace cyclorama {

/// The state of the light computations of a fake node, which a test sets and observes. Setters are for the test's
/// thread.
struct FakeLight {
  std::vector<std::string> begun{};  ///< Scenes whose computation was started, in order.
  std::filesystem::path file{};      ///< File of the last computation.
  std::atomic<bool> is_paused = false;
  std::atomic<bool> is_ended = false;  ///< True if the last computation was destroyed.
  double done_share = 0.0;
  std::vector<node::LightEvent> events{};  ///< Events for its next report.
  std::vector<std::string> orders{};       ///< Orders that it received, such as "compute 2-17".
  std::optional<Status> result{};  ///< Null while it works.
};

class FakeLightComputation final : public node::LightComputation {
 public:
  explicit FakeLightComputation(std::shared_ptr<FakeLight> shared) : shared_(std::move(shared)) {}
  ~FakeLightComputation() override { shared_->is_ended = true; }
  void pause() override { shared_->is_paused = true; }
  void resume() override { shared_->is_paused = false; }
  void compute(std::uint32_t stage, std::uint32_t piece) override { note("compute", stage, piece); }
  void fetched(std::uint32_t stage, std::uint32_t piece) override { note("fetched", stage, piece); }
  [[nodiscard]] std::vector<node::LightEvent> events() override { return std::exchange(shared_->events, {}); }
  [[nodiscard]] double done_share() override { return shared_->done_share; }
  [[nodiscard]] std::optional<Status> result() override { return shared_->result; }

 private:
  void note(const std::string& verb, std::uint32_t stage, std::uint32_t piece) {
    shared_->orders.push_back(verb + " " + std::to_string(stage) + "-" + std::to_string(piece));
  }

  const std::shared_ptr<FakeLight> shared_;
};

inline node::LightStarter fake_light_starter(const std::shared_ptr<FakeLight>& shared) {
  return [shared](const std::filesystem::path& scene,
                  const std::filesystem::path& file) -> Result<std::unique_ptr<node::LightComputation>> {
    shared->begun.push_back(scene.string());
    shared->file = file;
    shared->is_ended = false;
    return std::unique_ptr<node::LightComputation>(std::make_unique<FakeLightComputation>(shared));
  };
}

}  // namespace cyclorama
