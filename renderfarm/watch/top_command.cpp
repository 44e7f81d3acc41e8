// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/top_command.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

#include "common/wire/channel.h"
#include "common/wire/inspection.grpc.pb.h"
#include "renderfarm/watch/status_json.h"
#include "renderfarm/watch/top_text.h"

namespace cyclorama::watch {
namespace {

constexpr auto kPeriod = std::chrono::seconds(1);
constexpr auto kDeadline = std::chrono::seconds(2);
constexpr int kPlainColumns = 160;

Result<wire::ProcessStatus> request_status(wire::Inspection::Stub& stub, const std::string& address) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kDeadline);
  wire::ProcessStatus status;
  const grpc::Status answer = stub.GetStatus(&context, {}, &status);
  if (!answer.ok()) return from_grpc(answer, fmt::format("requesting the status of the coordinator at {}", address));
  return status;
}

int terminal_columns() {
  winsize size{};
  return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kPlainColumns;
}

void print(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

/// Uses the terminal's alternate screen, so that the shell's lines reappear afterwards.
class OtherPage {
 public:
  OtherPage() { print("\x1b[?1049h\x1b[?25l"); }
  ~OtherPage() { print("\x1b[?25h\x1b[?1049l"); }
  OtherPage(const OtherPage&) = delete;
  OtherPage& operator=(const OtherPage&) = delete;
  static void show(const std::string& text) { print("\x1b[H\x1b[J" + text); }
};

}  // namespace

Status run_top(const TopOptions& options, const StopSignal& stop) {
  const std::string address = options.inspect.empty() ? kPackagedInspect : options.inspect;
  TRY_ASSIGN(const auto channel, make_channel(address));
  const auto stub = wire::Inspection::NewStub(channel);
  TRY_ASSIGN(wire::ProcessStatus status, request_status(*stub, address));
  if (options.json || options.once || ::isatty(STDOUT_FILENO) == 0) {
    print(options.json ? status_json(status) : top_text(status, kPlainColumns));
    return Done{};
  }
  const OtherPage page;
  std::string trouble;
  do {
    OtherPage::show(top_text(status, terminal_columns()) + trouble);
    if (stop.wait_until(SteadyClock().now() + kPeriod)) return Done{};
    auto answer = request_status(*stub, address);
    trouble = answer ? "" : fmt::format("\n{}; the figures above are old\n", answer.error().message());
    if (answer) status = *std::move(answer);
  } while (true);
}

}  // namespace cyclorama::watch
