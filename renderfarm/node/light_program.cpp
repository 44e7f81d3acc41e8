// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_program.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <string>

#include "common/base/give_way.h"
#include "common/base/text.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/light_baking/bake_light.h"
#include "renderfarm/node/light_process.h"
#include "renderfarm/node/ordered_pieces.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::node {
namespace {

/// Approximate progress after reading the scene, and after building its BVH; the rest is the computation of light.
constexpr double kReadShare = 0.03;
constexpr double kBuiltShare = 0.05;
constexpr std::size_t kMaxErrorBytes = 1000;

Error write_error(const std::filesystem::path& file, const Error& reason) {
  const int number = reason.errno_value();
  if (number != ENOSPC && number != EDQUOT && number != EFBIG) return reason;
  return Error(
      ErrorCode::kSystem,
      fmt::format("writing '{}': its disk is full; free some of it, or give 'cache' another place", file.string()));
}

/// Sets the lowest possible priority, as far as a service's sandbox permits it.
void give_way_to_all() {
  constexpr int kAllSteps = 40;
  give_way(kAllSteps);
  const sched_param none{};
  ::sched_setscheduler(0, SCHED_IDLE, &none);
}

}  // namespace

Status compute_light(const std::filesystem::path& scene, const std::filesystem::path& file, int threads,
                     const std::function<void(double)>& progress, light_baking::LightPieces* pieces) {
  TRY_ASSIGN(scene::Scene loaded,
             scene::load_scene(scene, scene::ImportLimits{}, [&](double done) { progress(kReadShare * done); }));
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             render::Renderer::build(std::move(loaded), threads,
                                     [&](double done) { progress(kReadShare + (kBuiltShare - kReadShare) * done); }));
  TRY_ASSIGN(const light_baking::BakedLight baked,
             light_baking::bake_light(
                 *renderer, light_baking::BakeSettings{}, threads,
                 [&](double done) { progress(kBuiltShare + (1.0 - kBuiltShare) * done); }, nullptr, pieces));
  light::LightStore store = *baked.store;
  store.settings += ", cyclorama " CYCLORAMA_VERSION;  // Makes the program's version a part of the light's version.
  const Status written = light::write_light_file(file, store);
  if (!written) return write_error(file, written.error());
  return Done{};
}

Status run_light_program(const std::filesystem::path& scene, const std::filesystem::path& file, int threads) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // SIGXFSZ would end the process when it exceeds a limit on file size. If the signal is ignored, the write fails as on
  // a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  give_way_to_all();
  std::mutex mutex;  // Pieces are reported by several threads.
  const auto report = [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    fmt::print("{}\n", line);
    std::fflush(stdout);
  };
  OrderedPieces pieces(light_baking::unfinished_light(file), STDIN_FILENO, report);
  double reported = -1.0;
  Status done = compute_light(
      scene, file, threads,
      [&](double share) {
        constexpr double kStep = 0.005;
        {
          const std::lock_guard lock(mutex);
          if (share < reported + kStep) return;
          reported = share;
        }
        report(fmt::format("progress {:.3f}", share));
      },
      &pieces);
  if (done) pieces.remove();
  if (!done) report("error " + printable(done.error().message(), kMaxErrorBytes));
  return done;
}

LightStarter light_process_starter(int threads) {
  return [threads](const std::filesystem::path& scene, const std::filesystem::path& file) {
    return LightProcess::start({"/proc/self/exe", kLightOfOption, scene.string(), kLightFileOption, file.string(),
                                "--threads", std::to_string(threads)});
  };
}

}  // namespace cyclorama::node
