// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/caption/caption_writer.h"

#include <algorithm>
#include <utility>

namespace cyclorama::tour {

CaptionWriter::~CaptionWriter() { stop(); }

void CaptionWriter::write(std::optional<CaptionScript> script) {
  const std::lock_guard lock(mutex_);
  if (is_stopping_ || (!script && !script_)) return;
  script_ = std::move(script);
  is_new_ = true;
  if (!captions_.joinable()) captions_ = std::thread([this] { run(); });
  changed_.notify_one();
}

void CaptionWriter::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    changed_.notify_one();
  }
  if (captions_.joinable()) captions_.join();
}

std::string CaptionWriter::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

void CaptionWriter::clear() {
  if (std::exchange(is_written_, false)) send_(wire::Caption());
}

void CaptionWriter::run() {
  auto setter = CaptionSetter::open();
  std::optional<CaptionScript> script;
  std::optional<std::vector<CaptionText>> texts;  // Those that `pages` were set from.
  std::vector<CaptionPage> pages;
  constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t written = kNone;  // Number of the page on the wall.
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    if (std::exchange(is_new_, false)) {
      script = script_;
      texts.reset();
    }
    std::optional<TimePoint> next;
    std::string trouble;
    lock.unlock();
    if (!script || !setter) {
      if (script) trouble = setter.error().message();
      clear();
    } else {
      const TimePoint now = SteadyClock().now();
      CaptionMoment moment = caption_at(*script, now);
      next = moment.until;
      if (texts != moment.texts) {
        auto set = setter->set(moment.texts, caption_size(script->style, script->wall, script->parts.size()));
        if (!set) trouble = set.error().message();
        pages = set ? *std::move(set) : std::vector<CaptionPage>();
        texts = std::move(moment.texts);
        written = kNone;
      }
      if (pages.empty()) {
        clear();
      } else {
        std::optional<Duration> left;
        const std::size_t page = page_at(pages, now - moment.began_at, &left);
        if (left) next = std::min(next.value_or(TimePoint::max()), now + *left);
        if (written != page) send_(caption_on_wall(pages[page], script->style, script->wall));
        written = page;
        is_written_ = true;
      }
    }
    lock.lock();
    trouble_ = trouble;
    const auto is_due = [this] { return is_new_ || is_stopping_; };
    if (next) {
      changed_.wait_until(lock, *next, is_due);
    } else {
      changed_.wait(lock, is_due);
    }
  }
}

}  // namespace cyclorama::tour
