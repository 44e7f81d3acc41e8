// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/connector_watch.h"

#include <algorithm>
#include <utility>

namespace cyclorama::output {
namespace {

constexpr auto kLookAgain = std::chrono::seconds(5);

}  // namespace

ConnectorWatch::ConnectorWatch(std::unique_ptr<ProbeRunner> runner, const Clock& clock)
    : clock_(clock), look_again_at_(clock.now() + kLookAgain), runner_(std::move(runner)) {
  if (auto monitor = HotplugMonitor::open()) hotplug_.emplace(*std::move(monitor));
}

void ConnectorWatch::ask(TimePoint not_before) { asked_at_ = std::min(not_before, asked_at_.value_or(not_before)); }

void ConnectorWatch::step(bool is_any_dark, std::vector<WatchedCard> cards) {
  const TimePoint now = clock_.now();
  if (hotplug_ && hotplug_->take()) ask(now);
  if (is_reading_ || !runner_->is_idle()) return;
  const bool is_asked = asked_at_ && *asked_at_ <= now;
  const bool is_turn = now >= look_again_at_;
  if (!is_asked && !is_turn) return;
  look_again_at_ = now + kLookAgain;
  if (!is_asked && hotplug_ && !is_any_dark) return;
  if (is_asked) asked_at_.reset();
  reading_ = {std::move(cards), is_asked, {}};
  is_reading_ = true;
  runner_->start([reading = &reading_] {
    for (const WatchedCard& card : reading->cards) {
      const auto is_probed = [&](std::uint32_t id) {
        return reading->is_full || std::find(card.lit.begin(), card.lit.end(), id) == card.lit.end();
      };
      reading->connectors.push_back(card.card->read_connectors(is_probed));
    }
  });
}

std::optional<std::vector<Result<std::vector<Connector>>>> ConnectorWatch::take() {
  if (!is_reading_ || !runner_->is_idle()) return std::nullopt;
  is_reading_ = false;
  return std::move(reading_.connectors);
}

}  // namespace cyclorama::output
