// SPDX-License-Identifier: Apache-2.0
#include "common/http/answer_buffer.h"

#include <algorithm>
#include <utility>

namespace cyclorama {

bool AnswerBuffer::append(std::string_view bytes) {
  while (!bytes.empty()) {
    {
      std::unique_lock lock(mutex_);
      taken_.wait(lock, [&] { return is_closed_ || bytes_.size() < kMaxBytes; });
      if (is_closed_) return false;
      const std::size_t fits = std::min(bytes.size(), kMaxBytes - bytes_.size());
      bytes_ += bytes.substr(0, fits);
      bytes.remove_prefix(fits);
    }
    wake_();
  }
  return true;
}

void AnswerBuffer::finish(bool closes_connection) {
  {
    const std::lock_guard lock(mutex_);
    is_finished_ = true;
    closes_connection_ = closes_connection;
  }
  wake_();
}

std::string AnswerBuffer::take() {
  const std::lock_guard lock(mutex_);
  taken_.notify_all();
  return std::exchange(bytes_, {});
}

void AnswerBuffer::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  taken_.notify_all();
}

bool AnswerBuffer::is_full() const {
  const std::lock_guard lock(mutex_);
  return bytes_.size() >= kMaxBytes;
}

bool AnswerBuffer::is_finished() const {
  const std::lock_guard lock(mutex_);
  return is_finished_ && bytes_.empty();
}

bool AnswerBuffer::closes_connection() const {
  const std::lock_guard lock(mutex_);
  return closes_connection_;
}

}  // namespace cyclorama
