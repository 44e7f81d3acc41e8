// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/extremes_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/file.h"
#include "tests/bench/render/extremes/picture_case.h"
#include "tests/bench/render/extremes/ray_sweep.h"
#include "tests/bench/render/extremes/same_picture.h"
#include "tests/bench/render/trade/plot.h"

namespace cyclorama {
namespace {

struct ExtremesOptions {
  std::string out;
  std::string json;
  int threads = 0;
  bool quick = false;
};

/// One line of the table; values that were not measured are empty.
struct Row {
  std::string sweep;
  std::string name;
  double metres = 0.0;
  std::optional<double> flip = {};
  std::optional<std::uint64_t> rays = {};
  std::optional<std::uint64_t> leaks = {};
  std::optional<std::uint64_t> self_hits = {};
  std::optional<std::uint64_t> self_hits_fixed_near = {};
  std::optional<int> nan_pixels = {};
  std::optional<int> black_pixels = {};
  std::string fault = {};  ///< Empty if there is none.
};

template <typename T>
std::string text_of(const std::optional<T>& value) {
  return value ? fmt::format("{:.6g}", static_cast<double>(*value)) : std::string();
}

void print(const Row& row) {
  fmt::print("{:<46}{:>9}{:>10}{:>7}{:>10}{:>11}{:>5}{:>6}  {}\n", row.name, text_of(row.flip), text_of(row.rays),
             text_of(row.leaks), text_of(row.self_hits), text_of(row.self_hits_fixed_near), text_of(row.nan_pixels),
             text_of(row.black_pixels), row.fault.empty() ? "holds" : "FAILS " + row.fault);
}

class Sweep {
 public:
  explicit Sweep(const ExtremesOptions& options) : options_(options) {
    fmt::print("{:<46}{:>9}{:>10}{:>7}{:>10}{:>11}{:>5}{:>6}\n", "case", "FLIP", "rays", "leaks", "self-hits",
               "near 1e-4", "NaN", "black");
  }

  Status run(const StopSignal& stop) {
    TRY(run_same_pictures());
    if (stop.requested()) return tools::stopped();
    TRY(run_leaks());
    TRY(run_self_hits());
    for (const PictureCase& extreme : all_picture_cases()) {
      if (stop.requested()) return tools::stopped();
      run_picture(extreme);
    }
    return Done{};
  }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

 private:
  void add(Row row) {
    print(row);
    rows_.push_back(std::move(row));
  }
  void add_same(const char* sweep, const char* what, const std::vector<SamePicture>& pictures) {
    for (const SamePicture& picture : pictures) {
      Row row{sweep, fmt::format("{} {:g} m", what, picture.metres), picture.metres};
      row.flip = picture.flip;
      if (!(picture.flip <= kSameFlip)) row.fault = fmt::format("FLIP above {}", kSameFlip);
      add(std::move(row));
    }
  }

  Status run_same_pictures() {
    const int width_px = options_.quick ? 64 : 160;
    TRY_ASSIGN(const std::vector<SamePicture> far,
               far_from_the_origin({1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8}, width_px, options_.threads));
    add_same("far", "a room from the origin:", far);
    TRY_ASSIGN(const std::vector<SamePicture> sizes,
               scaled({6e-3, 6e-2, 0.6, 6.0, 60.0, 600.0, 6e3, 6e4}, width_px, options_.threads));
    add_same("scale", "a room of", sizes);
    return Done{};
  }

  Status run_leaks() {
    const int count = options_.quick ? 50'000 : 1'000'000;
    const auto measure = [&](const Eigen::Vector3d& centre) -> Status {
      TRY_ASSIGN(const LeakCount leaks, count_leaks(centre, count));
      Row row{"leaks", fmt::format("a sphere at ({:g}, {:g}, {:g})", centre.x(), centre.y(), centre.z()),
              centre.norm()};
      row.rays = leaks.rays;
      row.leaks = leaks.leaks;
      row.self_hits = leaks.self_hits;
      if (static_cast<double>(leaks.leaks) > kMaxLeakFraction * static_cast<double>(leaks.rays)) row.fault = "leaks";
      if (leaks.self_hits > 0) row.fault = "self-hits";
      add(std::move(row));
      return Done{};
    };
    for (const double metres : {100.0, 1e3, 1e4, 1e5}) TRY(measure(Eigen::Vector3d(0.6, 0.48, 0.64) * metres));
    return measure({148376.0, 1234.0, -223423.0});
  }

  Status run_self_hits() {
    const int count = options_.quick ? 20'000 : 300'000;
    for (const double coordinate : {1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8}) {
      TRY_ASSIGN(const SelfHitCount hits, count_self_hits(coordinate, count));
      Row row{"self-hits", fmt::format("random triangles at {:g}", coordinate), coordinate};
      row.rays = hits.rays;
      row.self_hits = hits.self_hits;
      row.self_hits_fixed_near = hits.self_hits_fixed_near;
      if (hits.self_hits > 0) row.fault = "self-hits";
      if (hits.rays == 0) row.fault = "no ray met a triangle";
      add(std::move(row));
    }
    return Done{};
  }

  void run_picture(const PictureCase& extreme) {
    Row row{"picture", extreme.name};
    const Result<PictureVerdict> verdict = judge(extreme, options_.out, options_.threads);
    if (!verdict) {
      row.fault = verdict.error().message();
      return add(std::move(row));
    }
    row.nan_pixels = verdict->nan_pixels();
    row.black_pixels = verdict->black;
    if (!verdict->holds()) row.fault = verdict->nan_pixels() > 0 ? "NaN" : "black";
    add(std::move(row));
  }

  const ExtremesOptions& options_;
  std::vector<Row> rows_;
};

std::string csv(const std::vector<Row>& rows) {
  std::string text = "sweep,case,metres,flip,rays,leaks,self_hits,self_hits_fixed_near,nan_pixels,black_pixels,fails\n";
  for (const Row& row : rows) {
    text +=
        fmt::format("{},\"{}\",{:g},{},{},{},{},{},{},{},{}\n", row.sweep, row.name, row.metres, text_of(row.flip),
                    text_of(row.rays), text_of(row.leaks), text_of(row.self_hits), text_of(row.self_hits_fixed_near),
                    text_of(row.nan_pixels), text_of(row.black_pixels), row.fault.empty() ? 0 : 1);
  }
  return text;
}

struct Plots {
  std::string pictures;
  std::string rays;
};

/// Zero has no logarithm; it is drawn at the value that the axis labels as none.
Plots plots_of(const std::vector<Row>& rows) {
  constexpr double kNoFlip = 1e-6;
  constexpr double kNoRays = 1e-7;
  PlotSeries far{"moved away", "#1f77b4", {}, true};
  PlotSeries scale{"of this length", "#2ca02c", {}, true};
  PlotSeries bounded{"self-hits", "#1f77b4", {}, true};
  PlotSeries fixed{"with tnear 1e-4", "#ff7f0e", {}, true};
  PlotSeries leaks{"leaks of a sphere", "#2ca02c", {}, true};
  for (const Row& row : rows) {
    const auto rate = [&](std::uint64_t count) {
      return std::max(kNoRays, static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(1, *row.rays)));
    };
    if (row.sweep == "far") far.points.push_back({row.metres, std::max(kNoFlip, *row.flip)});
    if (row.sweep == "scale") scale.points.push_back({row.metres, std::max(kNoFlip, *row.flip)});
    if (row.sweep == "leaks") leaks.points.push_back({row.metres, rate(*row.leaks)});
    if (row.sweep == "self-hits") {
      bounded.points.push_back({row.metres, rate(*row.self_hits)});
      fixed.points.push_back({row.metres, rate(*row.self_hits_fixed_near)});
    }
  }
  const PlotSeries max{"allowed", "#d62728", {{6e-3, kSameFlip}, {1e8, kSameFlip}}, true, 1.0};
  return {
      plot_svg("The same room elsewhere", {{"metres", fmt::format("FLIP; {:g} is none", kNoFlip), {max, scale, far}}}),
      plot_svg("Rays where float is coarse", {{"metres from the origin, nothing rebased",
                                               fmt::format("part of the rays; {:g} is none", kNoRays),
                                               {fixed, leaks, bounded}}})};
}

Status extremes(const ExtremesOptions& options, const StopSignal& stop) {
  std::error_code failed;
  std::filesystem::create_directories(options.out, failed);
  if (failed) {
    return Error(ErrorCode::kSystem, fmt::format("making the folder '{}': {}", options.out, failed.message()));
  }
  Sweep sweep(options);
  TRY(sweep.run(stop));
  const std::vector<Row>& rows = sweep.rows();
  const std::filesystem::path folder = options.out;
  TRY(write_file_atomically(folder / "extremes.csv", csv(rows)));
  const Plots plots = plots_of(rows);
  TRY(write_file_atomically(folder / "extremes-pictures.svg", plots.pictures));
  TRY(write_file_atomically(folder / "extremes-rays.svg", plots.rays));
  const auto failures = std::ranges::count_if(rows, [](const Row& row) { return !row.fault.empty(); });
  int nan_pixels = 0;
  for (const Row& row : rows) nan_pixels += row.nan_pixels.value_or(0);
  fmt::print("{} cases, {} fail, {} NaN pixels\n", rows.size(), failures, nan_pixels);
  if (!options.json.empty()) {
    TRY(tools::write_json(options.json, {{"cases", rows.size()}, {"failures", failures}, {"nan_pixels", nan_pixels}}));
  }
  if (failures > 0) return Error(ErrorCode::kBadData, fmt::format("{} of {} cases fail", failures, rows.size()));
  return Done{};
}

}  // namespace

tools::RenderCommand add_extremes_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("extremes", "Check that pictures and rays hold at the ends of what can be asked for");
  const auto options = std::make_shared<ExtremesOptions>();
  parser->add_option("--out", options->out, "The folder for extremes.csv, extremes-pictures.svg and extremes-rays.svg")
      ->required();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  parser->add_option("--threads", options->threads, "Threads; 0 is all")->check(CLI::Range(0, 1024));
  parser->add_flag("--quick", options->quick, "Smaller pictures and fewer rays");
  return {parser, [options](const StopSignal& stop) { return extremes(*options, stop); }};
}

}  // namespace cyclorama
