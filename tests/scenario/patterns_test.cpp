// SPDX-License-Identifier: Apache-2.0
// Real processes: a display, and a calibrator that is killed while its patterns stand on the wall.
//
//   patterns_test DISPLAY INSTALLATION          the scenario
//   patterns_test --calibrate ADDRESS PROJECTOR WIDTH HEIGHT SEED   the calibrator: shows noise, waits to be killed
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "common/base/unique_fd.h"
#include "common/image/png.h"
#include "common/room/installation.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"
#include "drivers/output/shared_picture.h"

namespace cyclorama {
namespace {

RgbImage noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  RgbImage picture(width, height);
  for (std::uint8_t& code : picture.data()) code = static_cast<std::uint8_t>(random());
  return picture;
}

int calibrate(const std::string& address, const std::string& projector, int width, int height, unsigned seed) {
  const auto channel = make_channel(address);
  const auto png = encode_png(noise(width, height, seed));
  if (!channel || !png) return 1;
  const auto stub = wire::PatternScreen::NewStub(*channel);
  grpc::ClientContext context;
  const auto stream = stub->ShowPatterns(&context);
  wire::PatternRequest order;
  wire::HeadPattern* const pattern = order.add_heads();
  pattern->set_projector(projector);
  pattern->set_png(png->data(), png->size());
  wire::PatternShown answer;
  if (!stream->Write(order) || !stream->Read(&answer)) {
    stream->WritesDone();
    std::fprintf(stderr, "%s\n", stream->Finish().error_message().c_str());
    return 1;
  }
  std::puts("shown");
  std::fflush(stdout);
  std::this_thread::sleep_for(std::chrono::minutes(5));
  return 0;
}

/// A child process that is killed by the destructor.
class Child {
 public:
  explicit Child(const std::vector<std::string>& command) {
    std::array<int, 2> ends{};
    CHECK(::pipe2(ends.data(), O_CLOEXEC) == 0);
    id_ = ::fork();
    CHECK(id_ >= 0);
    if (id_ == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      std::vector<char*> arguments;
      for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
      arguments.push_back(nullptr);
      ::execv(arguments[0], arguments.data());
      std::_Exit(127);
    }
    out_ = UniqueFd(ends[0]);
    ::close(ends[1]);
  }
  ~Child() { kill(SIGKILL); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Returns whether the process wrote something before it ended.
  [[nodiscard]] bool said_something() const {
    char letter = 0;
    return ::read(out_.get(), &letter, 1) == 1;
  }
  void kill(int signal) {
    if (id_ <= 0) return;
    ::kill(id_, signal);
    ::waitpid(id_, nullptr, 0);
    id_ = -1;
  }

 private:
  pid_t id_ = -1;
  UniqueFd out_;
};

class Wall {
 public:
  Wall(std::filesystem::path folder, const Installation& room) : folder_(std::move(folder)), room_(room) {}

  /// Returns the pictures of all heads; empty before they show anything.
  [[nodiscard]] std::vector<RgbImage> heads() const {
    std::vector<RgbImage> all;
    for (const InstalledProjector& projector : room_.projectors) {
      auto reader = output::SharedPictureReader::open(output::shared_picture_path(folder_, projector.name));
      RgbImage picture;
      if (!reader || !reader->read_newest(&picture)) return {};
      all.push_back(std::move(picture));
    }
    return all;
  }
  /// Waits until the heads' pictures have not changed for half a second.
  [[nodiscard]] std::vector<RgbImage> still_heads() const {
    std::vector<RgbImage> before;
    for (int same = 0, looks = 0; same < 10 && looks < 600; ++looks) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      std::vector<RgbImage> now = heads();
      same = !now.empty() && now == before ? same + 1 : 0;
      before = std::move(now);
    }
    return before;
  }
  [[nodiscard]] bool shows(const std::vector<RgbImage>& wanted) const {
    for (int looks = 0; looks < 400; ++looks) {
      if (heads() == wanted) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }

 private:
  std::filesystem::path folder_;
  const Installation& room_;
};

bool is_dark(const RgbImage& picture) {
  return std::ranges::all_of(picture.data(), [](std::uint8_t code) { return code == 0; });
}

int scenario(const std::string& self, const std::string& display, const std::string& installation) {
  const auto room = read_installation(installation);
  std::string folder = (std::filesystem::temp_directory_path() / "patterns-XXXXXX").string();
  if (!room || ::mkdtemp(folder.data()) == nullptr) return 1;
  const std::string address = "unix:" + folder + "/display.sock";
  int problems = 0;
  const auto expect = [&](bool is_so, const std::string& what) {
    if (!is_so) std::printf("not so: %s\n", what.c_str());
    problems += is_so ? 0 : 1;
  };
  {
    Child shown({display, "--installation", installation, "--tour", "[::1]:1", "--listen", address, "--run-dir", folder,
                 "--width", "512"});
    const Wall wall(folder, *room);
    const std::vector<RgbImage> show = wall.still_heads();
    expect(!show.empty() && !is_dark(show[0]), "the display shows its attract picture");
    for (const unsigned seed : {1U, 2U}) {  // The second one connects as soon as the first is killed.
      if (show.empty()) break;
      const InstalledProjector& projector = room->projectors[seed % room->projectors.size()];
      Child calibrator({self, "--calibrate", address, projector.name, std::to_string(projector.lens.width_px),
                        std::to_string(projector.lens.height_px), std::to_string(seed)});
      expect(calibrator.said_something(), "the display answers the calibrator");
      const std::vector<RgbImage> heads = wall.heads();
      for (std::size_t i = 0; i < heads.size(); ++i) {
        const bool is_its = room->projectors[i].name == projector.name;
        expect(is_its ? heads[i] == noise(projector.lens.width_px, projector.lens.height_px, seed) : is_dark(heads[i]),
               fmt::format("head {} shows {}", room->projectors[i].name, is_its ? "the pattern" : "nothing"));
      }
      calibrator.kill(SIGKILL);
      expect(wall.shows(show), "the show is back bit for bit");
    }
    shown.kill(SIGTERM);
  }
  std::filesystem::remove_all(folder);
  std::puts(problems == 0 ? "patterns: ok" : "patterns: failed");
  return problems == 0 ? 0 : 1;
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv, argv + argc);
  if (argc == 7 && words[1] == "--calibrate") {
    return cyclorama::calibrate(words[2], words[3], std::stoi(words[4]), std::stoi(words[5]),
                                static_cast<unsigned>(std::stoul(words[6])));
  }
  if (argc == 3) return cyclorama::scenario(std::filesystem::canonical("/proc/self/exe"), words[1], words[2]);
  std::fputs("patterns_test DISPLAY INSTALLATION\n", stderr);
  return 2;
}
