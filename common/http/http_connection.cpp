// SPDX-License-Identifier: Apache-2.0
#include "common/http/http_connection.h"

#include <fmt/format.h>
#include <poll.h>

#include <string_view>
#include <utility>

#include "common/http/request_extent.h"

namespace cyclorama {
namespace {

std::string refusal_text(int status) {
  const char* const why = status == 431   ? "the request's head is too long"
                          : status == 411 ? "send the body's length"
                          : status == 503 ? "too many requests wait; try again"
                                          : "the request is not HTTP";
  const std::string body = fmt::format("{{\"error\": \"{}\"}}", why);
  return fmt::format(
      "HTTP/1.1 {} Refused\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
      status, body.size(), body);
}

}  // namespace

HttpConnection::HttpConnection(HttpChannel channel, std::string peer, const ConnectionLimits& limits, TimePoint now)
    : channel_(std::move(channel)), peer_(std::move(peer)), limits_(limits), deadline_(now + limits.request_within) {}

HttpConnection::~HttpConnection() {
  if (answer_ != nullptr) answer_->close();
}

short HttpConnection::events() const {
  // While a worker answers, nothing more is read: a client cannot make this process store requests without end.
  if (wants_output_) return POLLOUT;
  return state_ == State::kAnswering ? 0 : POLLIN;
}

bool HttpConnection::is_done(HttpChannel::Progress progress) {
  wants_output_ = progress == HttpChannel::Progress::kWantsOutput;
  if (progress == HttpChannel::Progress::kClosed) state_ = State::kClosed;
  return progress == HttpChannel::Progress::kDone;
}

bool HttpConnection::proceed(TimePoint now) {
  if (state_ == State::kHandshake && is_done(channel_.handshake())) state_ = State::kReading;
  if (state_ == State::kAnswering) send(now);
  if (state_ == State::kEnding) drain();
  return state_ == State::kReading && read(now);
}

bool HttpConnection::read(TimePoint now) {
  const auto progress = channel_.read(&received_, limits_.max_head_bytes + limits_.max_body_bytes);
  const RequestExtent extent = request_extent(received_, limits_.max_head_bytes, limits_.max_body_bytes);
  if (extent.refusal != 0) {
    refuse(extent.refusal, now);
    return false;
  }
  if (extent.bytes != 0 && extent.bytes <= received_.size()) {
    request_bytes_ = extent.bytes;
    must_end_ = extent.is_body_left_out;
    return true;
  }
  if (is_idle_ && !received_.empty()) {
    is_idle_ = false;
    deadline_ = now + limits_.request_within;
  }
  is_done(progress);
  return false;
}

std::string HttpConnection::take_request(std::shared_ptr<AnswerBuffer> answer) {
  std::string request = received_.substr(0, request_bytes_);
  received_.erase(0, request_bytes_);
  answer_ = std::move(answer);
  state_ = State::kAnswering;
  wants_output_ = false;
  // The worker is trusted to end; what it has made ready has a deadline.
  deadline_ = TimePoint::max();
  return request;
}

void HttpConnection::send(TimePoint now) {
  for (;;) {
    if (sending_.empty()) {
      if (answer_->is_finished()) break;
      sending_ = answer_->take();
      deadline_ = sending_.empty() ? TimePoint::max() : now + limits_.answer_within;
      if (sending_.empty()) return;
    }
    std::string_view rest = sending_;
    const auto progress = channel_.write(&rest);
    sending_.erase(0, sending_.size() - rest.size());
    if (!is_done(progress)) return;
  }
  const bool ends = must_end_ || answer_->closes_connection();
  answer_.reset();
  if (ends) return end(now);
  state_ = State::kReading;
  is_idle_ = received_.empty();
  deadline_ = now + (is_idle_ ? limits_.idle : limits_.request_within);
}

void HttpConnection::refuse(int status, TimePoint now) {
  const std::string text = refusal_text(status);
  std::string_view rest = text;
  if (is_done(channel_.write(&rest))) {
    end(now);
  } else {
    state_ = State::kClosed;
  }
}

void HttpConnection::end(TimePoint now) {
  // Closing at once would discard the answer if the client still sends: its kernel would see a reset.
  channel_.end_output();
  state_ = State::kEnding;
  deadline_ = now + limits_.last_bytes;
  drain();
}

void HttpConnection::drain() {
  received_.clear();
  is_done(channel_.read(&received_, limits_.max_head_bytes));
}

}  // namespace cyclorama
