// SPDX-License-Identifier: Apache-2.0
#include "common/http/http_loop.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <map>
#include <utility>

#include "common/http/peer_network.h"

namespace cyclorama {
namespace {

constexpr int kTick_ms = 100;  // Deadlines are seconds.

std::string address_text(const sockaddr_storage& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address.ss_family == AF_INET6) {
    ::inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6&>(address).sin6_addr, text.data(), text.size());
  } else if (address.ss_family == AF_INET) {
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(address).sin_addr, text.data(), text.size());
  }
  return text.data();
}

}  // namespace

HttpLoop::HttpLoop(UniqueFd listener, SSL_CTX* tls, const Options& options, Answer answer, const Clock& clock)
    : listener_(std::move(listener)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      tls_(tls),
      options_(options),
      answer_(std::move(answer)),
      clock_(clock) {
  for (std::size_t i = 0; i < options_.threads; ++i) workers_.emplace_back([this] { work(); });
  loop_ = std::thread([this] { run(); });
}

HttpLoop::~HttpLoop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    tasks_.clear();
  }
  changed_.notify_all();
  wake();
  // The loop still sends what the workers write, so that none of them waits for ever.
  for (std::thread& worker : workers_) worker.join();
  is_over_ = true;
  wake();
  loop_.join();
}

void HttpLoop::wake() const {
  // A full counter wakes as well, so the result does not matter.
  static_cast<void>(::eventfd_write(wake_.get(), 1));
}

void HttpLoop::work() {
  for (;;) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return is_stopping_ || !tasks_.empty(); });
      if (is_stopping_) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    const bool closes = answer_(task.request, *task.answer);
    task.answer->finish(closes);
  }
}

void HttpLoop::run() {
  while (!is_over_) {
    wait_for_events();
    close_overdue();
  }
  // Answers that were finished while this ended.
  for (HttpConnection& connection : connections_) {
    if (connection.is_answering()) connection.proceed(clock_.now());
  }
}

void HttpLoop::wait_for_events() {
  std::vector<pollfd> polled;
  polled.reserve(connections_.size() + 2);
  polled.push_back({wake_.get(), POLLIN, 0});
  polled.push_back({listener_.get(), POLLIN, 0});
  for (const HttpConnection& connection : connections_) polled.push_back({connection.fd(), connection.events(), 0});
  if (::poll(polled.data(), polled.size(), kTick_ms) <= 0) return;
  eventfd_t ignored = 0;
  const bool is_woken = polled[0].revents != 0 && ::eventfd_read(wake_.get(), &ignored) == 0;
  std::size_t i = 2;
  for (auto at = connections_.begin(); at != connections_.end(); ++i) {
    const auto connection = at++;
    const bool is_broken = (polled[i].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    if (is_broken && connection->is_answering()) {
      connections_.erase(connection);
    } else if (polled[i].revents != 0 || (is_woken && connection->is_answering())) {
      proceed(*connection);
    }
  }
  if (polled[1].revents != 0) accept_all();
}

void HttpLoop::proceed(HttpConnection& connection) {
  if (!connection.proceed(clock_.now())) return;
  const auto buffer = std::make_shared<AnswerBuffer>([this] { wake(); });
  Task task{{connection.take_request(buffer), connection.peer()}, buffer};
  {
    const std::lock_guard lock(mutex_);
    if (is_stopping_) return;
    tasks_.push_back(std::move(task));
  }
  changed_.notify_one();
}

void HttpLoop::accept_all() {
  for (;;) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    UniqueFd socket(
        ::accept4(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.is_open() && (errno == EINTR || errno == ECONNABORTED)) continue;
    // Without a free file descriptor, the client that waits is let in at the cost of another.
    if (!socket.is_open() && (errno == EMFILE || errno == ENFILE) && make_room()) continue;
    if (!socket.is_open()) return;
    if (connections_.size() >= options_.max_connections && !make_room()) continue;
    const int yes = 1;
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    connections_.emplace_back(HttpChannel(std::move(socket), tls_), address_text(address), options_.connection,
                              clock_.now());
  }
}

/// Closes a connection without a finished request. Returns false if there is none.
bool HttpLoop::make_room() {
  std::map<std::string, std::vector<Connections::iterator>> by_network;
  for (auto at = connections_.begin(); at != connections_.end(); ++at) {
    if (!at->is_answering()) by_network[peer_network(at->peer())].push_back(at);
  }
  if (by_network.empty()) return false;
  const auto& most = std::max_element(by_network.begin(), by_network.end(), [](const auto& a, const auto& b) {
                       return a.second.size() < b.second.size();
                     })->second;
  connections_.erase(
      *std::min_element(most.begin(), most.end(), [](auto a, auto b) { return a->deadline() < b->deadline(); }));
  return true;
}

void HttpLoop::close_overdue() {
  bool is_stopping = false;
  {
    const std::lock_guard lock(mutex_);
    is_stopping = is_stopping_;
  }
  const TimePoint now = clock_.now();
  std::erase_if(connections_, [&](const HttpConnection& connection) {
    return connection.is_closed(now) || (is_stopping && connection.is_stuck());
  });
}

}  // namespace cyclorama
