// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/base/text.h"

// NOLINTNEXTLINE(readability-redundant-declaration): POSIX requires the program to declare it.
extern char** environ;

namespace cyclorama::node {
namespace {

constexpr std::size_t kMaxLineBytes = 4096;

Result<pid_t> spawned(const std::vector<std::string>& command, int input, int output) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t process = 0;
  errno = ::posix_spawn(&process, arguments.front(), &actions, &attributes, arguments.data(), environ);
  const Error error = Error::from_errno(fmt::format("starting '{}'", command.front()));
  const bool has_failed = errno != 0;
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (has_failed) return error;
  return process;
}

}  // namespace

Result<std::unique_ptr<LightComputation>> LightProcess::start(const std::vector<std::string>& command) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return Error::from_errno("making a pipe");
  UniqueFd from(ends[0]);
  const UniqueFd into(ends[1]);
  if (::fcntl(from.get(), F_SETFL, O_NONBLOCK) != 0) return Error::from_errno("making a pipe");
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return Error::from_errno("making a socket");
  UniqueFd orders(ends[0]);
  const UniqueFd input(ends[1]);
  TRY_ASSIGN(const pid_t process, spawned(command, input.get(), into.get()));
  return std::unique_ptr<LightComputation>(new LightProcess(process, std::move(orders), std::move(from)));
}

LightProcess::~LightProcess() {
  const pid_t process = process_.exchange(0);
  if (process == 0) return;
  // SIGKILL also ends a stopped process. The output file is renamed into place only when it is complete.
  ::kill(process, SIGKILL);
  ::waitpid(process, nullptr, 0);
}

void LightProcess::send_signal(int number) const {
  const pid_t process = process_;
  if (process != 0) ::kill(process, number);
}

void LightProcess::pause() { send_signal(SIGSTOP); }
void LightProcess::resume() { send_signal(SIGCONT); }

void LightProcess::compute(std::uint32_t stage, std::uint32_t piece) { send_order("compute", stage, piece); }
void LightProcess::fetched(std::uint32_t stage, std::uint32_t piece) { send_order("fetched", stage, piece); }

void LightProcess::send_order(const char* verb, std::uint32_t stage, std::uint32_t piece) const {
  const std::string order = fmt::format("{} {} {}", verb, stage, piece);
  // An order that does not fit, or that comes after the end, is lost; the coordinator repeats it.
  (void)::send(orders_.get(), order.data(), order.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

std::vector<LightEvent> LightProcess::events() {
  read_output();
  return std::exchange(events_, {});
}

double LightProcess::done_share() {
  read_output();
  return done_share_;
}

std::optional<Status> LightProcess::result() {
  if (process_ == 0) return Error(ErrorCode::kSystem, error_);
  int status = 0;
  // The process remains a zombie until process_ is 0, so a signal cannot reach another process that reuses its number.
  siginfo_t ended{};
  const auto id = static_cast<id_t>(process_.load());
  if (::waitid(P_PID, id, &ended, WEXITED | WNOHANG | WNOWAIT) != 0 || ended.si_pid == 0) return std::nullopt;
  read_output();
  const pid_t process = process_.exchange(0);
  ::waitpid(process, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return Status(Done{});
  if (error_.empty()) {
    error_ = WIFSIGNALED(status) ? fmt::format("it was ended by signal {}", WTERMSIG(status))
                                 : fmt::format("it ended with exit code {}", WEXITSTATUS(status));
  }
  return Status(Error(ErrorCode::kSystem, error_));
}

void LightProcess::read_output() {
  std::array<char, 4096> part{};
  for (;;) {
    const ssize_t n = ::read(output_.get(), part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    for (const char byte : std::string_view(part.data(), static_cast<std::size_t>(n))) {
      if (byte == '\n') {
        read_line(unread_);
        unread_.clear();
      } else if (unread_.size() < kMaxLineBytes) {
        unread_.push_back(byte);
      }
    }
  }
}

void LightProcess::read_line(const std::string& line) {
  constexpr std::string_view kProgress = "progress ";
  constexpr std::string_view kError = "error ";
  if (line.starts_with(kError)) error_ = printable(line.substr(kError.size()), kMaxLineBytes);
  if (line.starts_with("stage ") || line.starts_with("piece ")) {
    std::istringstream words(line);
    std::string verb;
    words >> verb;
    if (BegunStage stage; verb == "stage" && words >> stage.number >> stage.key >> stage.pieces) {
      std::string folder;
      std::getline(words >> std::ws, folder);
      stage.folder = folder;
      events_.emplace_back(std::move(stage));
    }
    if (TakenPiece piece; verb == "piece" && words >> piece.stage >> piece.piece >> piece.sha256 >> piece.bytes)
      events_.emplace_back(std::move(piece));
  }
  if (!line.starts_with(kProgress)) return;
  double share = 0.0;
  const auto [end, failure] = std::from_chars(line.data() + kProgress.size(), line.data() + line.size(), share);
  if (failure == std::errc() && share >= 0.0) done_share_ = std::min(share, 1.0);
}

}  // namespace cyclorama::node
