// SPDX-License-Identifier: Apache-2.0
// Known pictures on the heads of this machine's graphics card, for tests/image/heads_test.py: eight colour bars, and in
// the lowest 32 rows as many white squares as the head's number. As a virtual machine's first process, it also mounts
// file systems and loads /modules/*. Prints "wall: ..." once it shows and whenever the heads' modes change, and
// "pacing: ..." after every 200 pictures.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "common/base/percentiles.h"
#include "drivers/output/drm/drm_output.h"
#include "drivers/output/gl_objects.h"
#include "drivers/output/pacing_meter.h"

namespace cyclorama {
namespace {

constexpr int kPicturesPerReport = 200;
constexpr char kVertexShader[] = R"(#version 300 es
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";
constexpr char kFragmentShader[] = R"(#version 300 es
precision highp float;
uniform vec4 head;  // Its number from 1, the picture's width.
out vec4 colour;
void main() {
  int bar = int(floor(8.0 * gl_FragCoord.x / head.y));
  colour = vec4(float(bar & 1), float(bar >> 1 & 1), float(bar >> 2 & 1), 1.0);
  if (gl_FragCoord.y < 32.0) {
    float square = floor(gl_FragCoord.x / 32.0);
    float lit = mod(square, 2.0) == 0.0 && square < 2.0 * head.x ? 1.0 : 0.0;
    colour = vec4(vec3(lit), 1.0);
  }
}
)";

void become_first_process() {
  ::mkdir("/dev", 0755);
  ::mkdir("/proc", 0755);
  ::mkdir("/sys", 0755);
  ::mount("none", "/dev", "devtmpfs", 0, nullptr);
  ::mount("none", "/proc", "proc", 0, nullptr);
  ::mount("none", "/sys", "sysfs", 0, nullptr);
  const int console = ::open("/dev/console", O_RDWR);
  for (int fd = 0; fd < 3; ++fd) ::dup2(console, fd);
  std::vector<std::filesystem::path> modules;
  for (const auto& entry : std::filesystem::directory_iterator("/modules")) modules.push_back(entry.path());
  std::sort(modules.begin(), modules.end());
  for (const std::filesystem::path& module : modules) {
    const int fd = ::open(module.c_str(), O_RDONLY | O_CLOEXEC);
    if (::syscall(SYS_finit_module, fd, "", 0) != 0) std::perror(module.c_str());
    ::close(fd);
  }
}

/// Pacing of the last pictures on one head. A picture's age counts from when its drawing began.
class HeadPacing {
 public:
  void take(const output::HeadShown& shown, TimePoint begun_at) {
    if (shown.light == output::HeadShown::Light::kNew) ages_ms_.add(to_milliseconds(shown.at - begun_at));
    const auto step = meter_.take(shown);
    if (!step) return;
    intervals_ms_.add(to_milliseconds(step->interval));
    late_ += step->is_late ? 1U : 0U;
    missed_ += step->missed;
  }
  [[nodiscard]] std::string text() const {
    return fmt::format(
        "{} intervals: {} late, {} refreshes missed; p50 {:.2f} ms, p95 {:.2f} ms, p99 {:.2f} ms; age p50 {:.2f} ms, "
        "p95 {:.2f} ms, p99 {:.2f} ms",
        intervals_ms_.count(), late_, missed_, intervals_ms_.at(0.50), intervals_ms_.at(0.95), intervals_ms_.at(0.99),
        ages_ms_.at(0.50), ages_ms_.at(0.95), ages_ms_.at(0.99));
  }

 private:
  output::PacingMeter meter_;
  Percentiles intervals_ms_;
  Percentiles ages_ms_;
  std::uint64_t late_ = 0;
  std::uint64_t missed_ = 0;
};

Status show(output::Output* output, const Clock& clock) {
  TRY_ASSIGN(const output::GlProgram program, output::GlProgram::link(output->gl(), kVertexShader, kFragmentShader));
  const output::GlVertexArray no_attributes(output->gl());
  const output::Gl& gl = output->gl();
  std::string said;
  std::vector<HeadPacing> pacing(output->heads().size());
  int pictures = 0;
  for (;;) {
    TRY(output->wait_for_refresh());
    const TimePoint begun_at = clock.now();
    for (std::size_t head = 0; head < output->heads().size(); ++head) {
      TRY(output->draw_to(head));
      gl.UseProgram(program.id());
      gl.Uniform4f(program.uniform("head"), static_cast<float>(head + 1),
                   static_cast<float>(output->heads()[head].width_px), 0.0f, 0.0f);
      gl.BindVertexArray(no_attributes.id());
      gl.DrawArrays(GL_TRIANGLES, 0, 3);
    }
    TRY_ASSIGN(const output::Presented presented, output->present());
    if (const std::string kind = output->kind(); kind != said) {
      fmt::print("wall: {}; {}; refresh {}\n", kind, gl.renderer(), presented.refresh);
      said = kind;
      pictures = 0;
      pacing.assign(pacing.size(), {});
    }
    for (std::size_t head = 0; head < pacing.size(); ++head) pacing[head].take(output->shown()[head], begun_at);
    if (++pictures == kPicturesPerReport) {
      for (std::size_t head = 0; head < pacing.size(); ++head)
        fmt::print("pacing: head {}: {}\n", head + 1, pacing[head].text());
      pictures = 0;
      pacing.assign(pacing.size(), {});
    }
    std::fflush(stdout);
  }
}

Status run(int heads, int width_px, int height_px) {
  const SteadyClock clock;
  output::DrmOptions options;
  for (int head = 0; head < heads; ++head)
    options.heads.push_back(
        {{fmt::format("head {}", head + 1), width_px, height_px}, fmt::format("Virtual-{}", head + 1)});
  for (;;) {
    TRY_ASSIGN(const std::unique_ptr<output::Output> output, output::open_drm_output(options, clock));
    const auto shown = show(output.get(), clock);
    if (shown.error().code() != ErrorCode::kUnavailable) return shown;
    fmt::print("wall: lost: {}\n", shown.error().message());
  }
}

}  // namespace
}  // namespace cyclorama

int main() {
  using namespace cyclorama;
  const bool is_first = ::getpid() == 1;
  if (is_first) become_first_process();
  const auto ended = run(3, 640, 480);
  fmt::print("wall: failed: {}\n", ended.error().message());
  std::fflush(stdout);
  if (is_first) ::reboot(RB_POWER_OFF);
  return 1;
}
