// SPDX-License-Identifier: Apache-2.0
#include "common/process/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>

#include "common/base/check.h"
#include "common/base/unique_fd.h"

// NOLINTNEXTLINE(readability-redundant-declaration): POSIX requires the program to declare it.
extern char** environ;

namespace cyclorama {
namespace {

/// Plan for the child's initial state. Signals that are blocked in this process must not be blocked in the child.
class SpawnPlan {
 public:
  explicit SpawnPlan(int output) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDERR_FILENO);
    posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigset_t all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    // A process group of its own, so that processes that the child started are killed with it.
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;
  int spawn(pid_t* ret_pid, const std::vector<std::string>& command) {
    std::vector<std::string> words = command;
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    return ::posix_spawnp(ret_pid, arguments.front(), &actions_, &attributes_, arguments.data(), environ);
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

/// Reads until the child closes its end of the pipe; returns false at the deadline.
bool read_until(int fd, TimePoint deadline, std::size_t max_bytes, ChildEnd* ret_end) {
  std::array<char, 8192> part{};
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - SteadyClock().now());
    if (left.count() <= 0) return false;
    pollfd waiting{fd, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(std::min<std::int64_t>(left.count(), 1000)));
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t n = ::read(fd, part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    const std::size_t received = static_cast<std::size_t>(n);
    const std::size_t room = max_bytes - std::min(max_bytes, ret_end->output.size());
    ret_end->output.append(part.data(), std::min(received, room));
    if (received > room) ret_end->is_cut = true;
  }
}

/// Waits for the child's end, since a program may close its output and continue. Returns false at the deadline.
bool reaped(pid_t pid, TimePoint deadline, int* ret_status) {
  for (;;) {
    const pid_t ended = ::waitpid(pid, ret_status, WNOHANG);
    if (ended == pid || (ended < 0 && errno != EINTR)) return true;
    if (SteadyClock().now() >= deadline) return false;
    SteadyClock().wait_until(SteadyClock().now() + std::chrono::milliseconds(5));
  }
}

}  // namespace

Result<ChildEnd> run_child(const std::vector<std::string>& command, const ChildLimits& limits) {
  CHECK(!command.empty());
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return Error::from_errno("making a pipe");
  const UniqueFd from(ends[0]);
  UniqueFd into(ends[1]);
  pid_t pid = -1;
  errno = SpawnPlan(into.get()).spawn(&pid, command);
  if (errno != 0) return Error::from_errno(fmt::format("starting '{}'", command.front()));
  into.reset();
  const TimePoint deadline = SteadyClock().now() + limits.time_limit;
  ChildEnd end;
  int status = 0;
  if (!read_until(from.get(), deadline, limits.max_bytes, &end) || !reaped(pid, deadline, &status)) {
    ::kill(-pid, SIGKILL);
    ::waitpid(pid, &status, 0);
    return Error(ErrorCode::kTimedOut,
                 fmt::format("'{}' did not end within {:.0f} s", command.front(), to_seconds(limits.time_limit)));
  }
  end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return end;
}

}  // namespace cyclorama
