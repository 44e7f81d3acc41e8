// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "common/process/program.h"
#include "common/process/progress.h"
#include "renderfarm/generator/interior.h"
#include "renderfarm/generator/package.h"

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::generator;  // NOLINT(google-build-using-namespace)
  Program program(
      "cyclorama-grotto",
      "Makes a painted cave temple, a museum hall or a relic, of any number of triangles, as a scene package.");
  PackageOrder order;
  // More threads than there are large files would not speed it up.
  order.threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 8);
  CLI::App& options = program.options();
  std::string kind = "grotto";
  options
      .add_option("--kind", kind,
                  "A grotto, or for measurements a matte museum hall or a relic before an empty background")
      ->check(CLI::IsMember({"grotto", "interior", "relic"}))
      ->capture_default_str();
  options.add_option("--lamps", order.lamps, "Number of lamps of an interior; their total light is always the same")
      ->check(CLI::Range(1, kMaxInteriorLamps))
      ->capture_default_str();
  options.add_option("--triangles", order.triangles, "Maximum number of triangles, nearly reached")
      ->check(CLI::Range(kMinTriangles, kMaxTriangles))
      ->capture_default_str();
  options.add_option("--seed", order.seed, "Seed of rock, damage and the order of the figures")->capture_default_str();
  options.add_option("--out", order.folder, "The scene package: a folder that does not exist yet")->required();
  options.add_flag("--force", order.replace, "Replace an existing grotto in --out");
  options.add_option("--threads", order.threads, "Number of threads; does not affect the result")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  return program.run(argc, argv, [&](const StopSignal& stop) -> Status {
    order.kind = kind == "interior" ? Kind::kInterior : kind == "relic" ? Kind::kRelic : Kind::kGrotto;
    Progress progress(kind);
    TRY_ASSIGN(const PackageReport report, write_package(order, [&](double fraction) {
                 progress.update(fraction);
                 return !stop.requested();
               }));
    fmt::print("{}: {} triangles, {} vertices, {:.1f} MB\n", order.folder.string(), report.counts.triangles,
               report.counts.vertices, static_cast<double>(report.bytes) / 1e6);
    return Done{};
  });
}
