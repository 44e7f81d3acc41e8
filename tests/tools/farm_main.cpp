// SPDX-License-Identifier: Apache-2.0
// test-farm: a farm of plain or striped pictures with a given rendering time, and, once a tour is connected, a visitor
// who turns continuously. For tests/bench/display/sync.py and tests/bench/visitor/motion_to_photon.py. Prints "port N",
// reads the tour's address, and at the end prints the tour's gauges and state.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "common/process/program.h"
#include "common/wire/inspection.grpc.pb.h"
#include "common/wire/museum.grpc.pb.h"
#include "tests/doubles/fake_farm.h"

namespace cyclorama {
namespace {

/// A visitor who steers by keys.
class Visitor {
 public:
  static Result<Visitor> at(const std::string& tour) {
    TRY_ASSIGN(std::shared_ptr<grpc::Channel> channel, make_channel(tour));
    return Visitor(std::move(channel));
  }
  /// Keys are held for 300 ms.
  void turn() const {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(2));
    wire::SteerRequest request;
    request.set_turn(0.3);
    wire::SteerReply reply;
    // May fail while the tour starts.
    static_cast<void>(wire::Tour::NewStub(channel_)->Steer(&context, request, &reply));
  }
  void print_gauges() const {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(2));
    wire::ProcessStatus status;
    if (!wire::Inspection::NewStub(channel_)->GetStatus(&context, {}, &status).ok()) return;
    for (const wire::Gauge& gauge : status.gauges()) fmt::print("{} {}\n", gauge.name(), gauge.value());
    fmt::print("{}\n", status.state());
  }

 private:
  explicit Visitor(std::shared_ptr<grpc::Channel> channel) : channel_(std::move(channel)) {}
  std::shared_ptr<grpc::Channel> channel_;
};

Status run(double min_ms, double max_ms, bool striped, const StopSignal& stop) {
  FakeFarm farm;
  farm.set_striped(striped);
  const auto ms = [](double value) {
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double, std::milli>(value));
  };
  farm.set_frame_time(ms(min_ms), ms(max_ms));
  fmt::print("port {}\n", farm.port());
  std::fflush(stdout);
  std::string tour;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!stop.requested() && ::poll(&input, 1, 100) == 0) continue;
  if (!std::getline(std::cin, tour)) return Done{};
  TRY_ASSIGN(const Visitor visitor, Visitor::at(tour));
  while (!stop.wait_until(SteadyClock().now() + std::chrono::milliseconds(100))) visitor.turn();
  visitor.print_gauges();
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  Program program("test-farm", "A farm of plain pictures, and a visitor who turns for ever.");
  double min_ms = 35.0;
  double max_ms = 65.0;
  bool striped = false;
  program.options().add_flag("--striped", striped);
  program.options().add_option("--min-ms", min_ms);
  program.options().add_option("--max-ms", max_ms);
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(min_ms, max_ms, striped, stop); });
}
