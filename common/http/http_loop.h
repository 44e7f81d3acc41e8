// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/base/unique_fd.h"
#include "common/http/http_connection.h"

namespace cyclorama {

/// Accepts connections and reads requests in one thread, which never blocks, and answers whole requests in a pool of
/// threads. So clients that are slow cost memory only. When all connections are taken, the unfinished request with the
/// nearest deadline is closed, among those of the network with the most. Thread-bound.
class HttpLoop {
 public:
  struct Options {
    ConnectionLimits connection;
    std::size_t threads = 1;
    std::size_t max_connections = 1;
  };
  struct Request {
    std::string bytes;  ///< Head and body.
    std::string peer;   ///< The client's address.
  };
  /// Answers a request. Returns whether the connection is to be closed. Called on the pool's threads.
  using Answer = std::function<bool(const Request& request, AnswerBuffer& answer)>;

  /// `listener` is bound and listens. `tls` is borrowed; null: no TLS. `clock` is borrowed; a clock that a test
  /// advances takes effect within kTick.
  HttpLoop(UniqueFd listener, SSL_CTX* tls, const Options& options, Answer answer, const Clock& clock);
  ~HttpLoop();
  HttpLoop(const HttpLoop&) = delete;
  HttpLoop& operator=(const HttpLoop&) = delete;

 private:
  struct Task {
    Request request;
    std::shared_ptr<AnswerBuffer> answer;
  };
  using Connections = std::list<HttpConnection>;

  void run();
  void work();
  void wait_for_events();
  void accept_all();
  bool make_room();
  void proceed(HttpConnection& connection);
  void close_overdue();
  void wake() const;

  UniqueFd listener_;
  UniqueFd wake_;  ///< An eventfd(2).
  SSL_CTX* const tls_;
  const Options options_;
  const Answer answer_;
  const Clock& clock_;
  Connections connections_;  ///< The loop's alone.

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  bool is_stopping_ = false;

  std::atomic<bool> is_over_{false};
  std::vector<std::thread> workers_;
  std::thread loop_;
};

}  // namespace cyclorama
