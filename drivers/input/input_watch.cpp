// SPDX-License-Identifier: Apache-2.0
#include "drivers/input/input_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/base/text.h"

namespace cyclorama::input {
namespace {

constexpr int kMaxEvents = 4096;  // Upper bound per update, so that a faulty device cannot block the others.

}  // namespace

void InputWatch::look() {
  const std::vector<std::string> listed = devices_.list();
  const std::set<std::string> there(listed.begin(), listed.end());
  std::erase_if(open_, [&](const auto& entry) { return !there.contains(entry.first); });
  std::erase_if(useless_, [&](const std::string& path) { return !there.contains(path); });
  failures_.clear();
  for (const std::string& path : there) {
    if (open_.contains(path) || useless_.contains(path)) continue;
    auto device = devices_.open(path);
    if (!device) {
      failures_[path] = device.error().message();
      continue;
    }
    const InputDescription& description = (*device)->description();
    const std::optional<InputKind> kind = kind_of(description);
    if (kind) {
      InputSteering steering(*kind, description);
      open_.emplace(path, Open{*std::move(device), std::move(steering)});
    } else {
      useless_.insert(path);
    }
  }
}

void InputWatch::update(TimePoint now) {
  if (!looked_ || now - looked_at_ >= kLook) {
    looked_ = true;
    looked_at_ = now;
    look();
  }
  for (auto entry = open_.begin(); entry != open_.end();)
    entry = read(&entry->second, now) ? std::next(entry) : open_.erase(entry);
}

bool InputWatch::read(Open* open, TimePoint now) {
  const unsigned helped_before = open->steering.help_presses();
  for (int i = 0; i < kMaxEvents; ++i) {
    const auto event = open->device->next();
    if (!event) return false;
    if (!*event) return true;
    open->steering.take(**event, now);
    is_help_wanted_ = is_help_wanted_ || open->steering.help_presses() != helped_before;
  }
  return true;
}

InputCommand InputWatch::command(TimePoint now) const {
  InputCommand sum;
  for (const auto& [path, open] : open_) {
    const InputCommand command = open.steering.command(now);
    sum.forward += command.forward;
    sum.right += command.right;
    sum.turn += command.turn;
  }
  const auto limited = [](double value) { return std::clamp(value, -1.0, 1.0); };
  return {limited(sum.forward), limited(sum.right), limited(sum.turn)};
}

int InputWatch::take_steps() {
  int steps = 0;
  for (auto& [path, open] : open_) steps += open.steering.take_steps();
  return steps;
}

int InputWatch::take_languages() {
  int languages = 0;
  for (auto& [path, open] : open_) languages += open.steering.take_languages();
  return languages;
}

std::vector<std::string> InputWatch::sentences() const {
  std::vector<std::string> sentences;
  for (const auto& [path, open] : open_)
    sentences.push_back(fmt::format("{} '{}'", to_text(open.steering.kind()), printable(open.steering.name())));
  for (const auto& [path, failure] : failures_) sentences.push_back(failure);
  return sentences;
}

}  // namespace cyclorama::input
