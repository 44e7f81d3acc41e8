// SPDX-License-Identifier: Apache-2.0
// Writes, reads, compares and rewrites many generated warps of each format. As many corrupted ones must be refused by
// an error that names the file, the position and the remedy. Usage: interchange_round_trips FILES_PER_FORMAT FOLDER
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>

#include "appliance/interchange/mask_png.h"
#include "appliance/interchange/mesh_files.h"
#include "appliance/interchange/mpcdi.h"
#include "appliance/interchange/warp_pfm.h"
#include "common/base/file.h"
#include "common/base/text.h"
#include "tests/bench/interchange/corruptions.h"

namespace cyclorama {
namespace {

using Path = std::filesystem::path;

struct Counts {
  int files = 0;
  int identical = 0;
  int corrupted = 0;
  int rejected = 0;
};

std::string bytes_in(const Path& path) {
  auto text = read_text_file(path, std::size_t{1} << 30);
  CHECK(text.has_value());
  return *std::move(text);
}

void put(const Path& path, const std::string& bytes) {
  CHECK(write_file_atomically(path, std::string_view(bytes)).has_value());
}

/// Returns true if the error names the file, then a position in it, then after a semicolon the remedy.
bool says_all(const Error& error, const Path& path) {
  static const std::regex position(
      "(byte|line|member|region|buffer|mesh node|PNG|end|display|zip directory|mpcdi.xml|SimCAD|mesh)");
  const std::string& text = error.message();
  const std::size_t name = text.find(path.string());
  if (error.code() != ErrorCode::kBadData || name == std::string::npos) return false;
  const std::string rest = text.substr(name + path.string().size());
  return std::regex_search(rest, position) && rest.find("; ") != std::string::npos;
}

class Bench {
 public:
  Bench(int files, Path folder) : files_(files), folder_(std::move(folder)) {}

  /// `trip` writes a generated warp to the path, reads it, and returns true if it is unchanged, byte by byte for
  /// formats that we write. `broken` corrupts the file; `read` reads it again.
  void format(const std::string& name, const std::string& ending,
              const std::function<bool(GeneratedWarps*, const Path&)>& trip,
              const std::function<std::vector<Corrupted>(const std::string&, GeneratedWarps*)>& broken,
              const std::function<Status(const Path&)>& read) {
    Counts counts;
    for (int i = 0; i < files_; ++i) {
      GeneratedWarps made(static_cast<std::uint32_t>(1000 * results_.size()) + static_cast<std::uint32_t>(i));
      const Path path = folder_ / fmt::format("{}-{}{}", name, i, ending);
      ++counts.files;
      if (trip(&made, path)) {
        ++counts.identical;
      } else {
        fmt::print(stderr, "{}: {} did not come back as it was\n", name, path.string());
      }
      for (const Corrupted& corrupted : broken(bytes_in(path), &made)) {
        put(path, corrupted.bytes);
        ++counts.corrupted;
        const Status status = read(path);
        if (!status && says_all(status.error(), path)) {
          ++counts.rejected;
        } else {
          fmt::print(stderr, "{}: {}: {}\n", name, corrupted.how, status ? "accepted" : status.error().message());
        }
      }
      std::filesystem::remove(path);
    }
    fmt::print("{:<16}{:>8}{:>11}{:>11}{:>10}\n", name, counts.files, counts.identical, counts.corrupted,
               counts.rejected);
    results_[name] = {{"files", counts.files},
                      {"identical", counts.identical},
                      {"corrupted", counts.corrupted},
                      {"rejected", counts.rejected}};
  }
  [[nodiscard]] const nlohmann::json& results() const { return results_; }

 private:
  int files_;
  Path folder_;
  nlohmann::json results_ = nlohmann::json::object();
};

template <typename T>
Status status_of(const Result<T>& result) {
  return result ? Status(Done{}) : Status(result.error());
}

bool is_near(const interchange::WarpNet& a, const interchange::WarpNet& b, double precision) {
  if (a.columns != b.columns || a.rows != b.rows || a.triangles != b.triangles || a.nodes.size() != b.nodes.size()) {
    return false;
  }
  const auto near = [&](double x, double y) { return std::abs(x - y) <= precision; };
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    const interchange::WarpNode& m = a.nodes[i];
    const interchange::WarpNode& n = b.nodes[i];
    if (!near(m.x, n.x) || !near(m.y, n.y) || !near(m.u, n.u) || !near(m.v, n.v) || !near(m.light, n.light)) {
      return false;
    }
  }
  return true;
}

constexpr double kSevenDecimals = 6e-8;
constexpr double kAspect = 1.6;

bool trip_mpcdi(GeneratedWarps* made, const Path& path, interchange::WarpProfile profile) {
  const interchange::WarpSet set =
      made->set(profile, made->count(0, 1) == 0 ? interchange::MpcdiVersion::k1_0 : interchange::MpcdiVersion::k2_0);
  CHECK(interchange::write_mpcdi(path, set).has_value());
  const auto back = interchange::read_mpcdi(path);
  if (!back || !(back->set == set)) return false;
  const std::string first = bytes_in(path);
  return interchange::write_mpcdi(path, back->set).has_value() && bytes_in(path) == first;
}

bool trip_pair(GeneratedWarps* made, const Path& path) {
  const Path mask = Path(path).replace_extension(".png");
  interchange::WarpRegion region = made->region(interchange::WarpProfile::k2d, path.stem().string());
  region.beta.reset();
  region.alpha = interchange::MaskMap(region.width_px, region.height_px, 1, 16);
  for (std::uint16_t& sample : region.alpha->samples) sample = static_cast<std::uint16_t>(made->count(0, 65535));
  CHECK(interchange::write_warp_pair(path, mask, region).has_value());
  const auto back = interchange::read_warp_pair(path, mask, interchange::WarpProfile::k2d);
  if (!back || !(*back == region)) return false;
  const std::string first = bytes_in(path) + bytes_in(mask);
  const bool is_same =
      interchange::write_warp_pair(path, mask, *back).has_value() && bytes_in(path) + bytes_in(mask) == first;
  std::filesystem::remove(mask);
  return is_same;
}

bool trip_bourke(GeneratedWarps* made, const Path& path) {
  const interchange::WarpNet net = made->grid();
  CHECK(interchange::write_bourke(path, net, kAspect).has_value());
  const auto back = interchange::read_bourke(path, kAspect);
  if (!back || !is_near(*back, net, kSevenDecimals)) return false;
  const std::string first = bytes_in(path);
  return interchange::write_bourke(path, *back, kAspect).has_value() && bytes_in(path) == first;
}

bool trip_obj(GeneratedWarps* made, const Path& path) {
  const interchange::WarpNet net = made->triangles();
  CHECK(interchange::write_warp_obj(path, net).has_value());
  const auto back = interchange::read_warp_obj(path);
  if (!back || !is_near(*back, net, kSevenDecimals)) return false;
  const std::string first = bytes_in(path);
  return interchange::write_warp_obj(path, *back).has_value() && bytes_in(path) == first;
}

/// We only read this and the next format, so the file is composed here as its programs write it.
bool trip_domeprojection(GeneratedWarps* made, const Path& path) {
  interchange::WarpNet net = made->grid();
  std::string text = "x;y;u;v;column;row\n";
  for (std::size_t i = 0; i < net.nodes.size(); ++i) {
    interchange::WarpNode& n = net.nodes[i];
    n.light = 1.0;
    const auto columns = static_cast<std::size_t>(net.columns);
    text +=
        fmt::format("{:.9f};{:.9f};{:.9f};{:.9f};{};{}\n", n.x, 1.0 - n.y, n.u, 1.0 - n.v, i % columns, i / columns);
  }
  put(path, text);
  const auto back = interchange::read_domeprojection(path);
  return back && is_near(*back, net, 1e-9);
}

bool trip_simcad(GeneratedWarps* made, const Path& path) {
  interchange::WarpNet net;
  net.columns = net.rows = made->count(2, 33);
  std::string right;
  std::string down;
  const double range = made->number(1.0, 4000.0);
  for (int j = 0; j < net.rows; ++j) {
    for (int i = 0; i < net.columns; ++i) {
      interchange::WarpNode n{0.0, 0.0, static_cast<double>(i) / (net.columns - 1),
                              1.0 - static_cast<double>(j) / (net.rows - 1), 1.0};
      n.x = n.u + made->number(-0.05, 0.05);
      n.y = n.v + made->number(-0.05, 0.05);
      net.nodes.push_back(n);
      right += fmt::format("{:.9f} ", (n.x - n.u) * range);
      down += fmt::format("{:.9f} ", (n.v - n.y) * range);
    }
  }
  put(path,
      fmt::format("<?xml version=\"1.0\"?>\n<GeometryFile>\n<GeometryDefinition>\n<X-FlatParameters range=\"{0:.12f}\">"
                  "{1}</X-FlatParameters>\n<Y-FlatParameters range=\"{0:.12f}\">{2}</Y-FlatParameters>\n"
                  "</GeometryDefinition>\n</GeometryFile>\n",
                  range, right, down));
  const auto back = interchange::read_simcad(path);
  return back && is_near(*back, net, 1e-9);
}

int run(int files, const Path& folder) {
  fmt::print("{:<16}{:>8}{:>11}{:>11}{:>10}\n", "format", "files", "identical", "corrupted", "rejected");
  Bench bench(files, folder);
  bench.format("pfm_png16", ".pfm", trip_pair, corrupted_pfm, [](const Path& path) {
    return status_of(interchange::read_warp_pair(path, std::nullopt, interchange::WarpProfile::k2d));
  });
  for (const auto& [name, profile] :
       {std::pair{"mpcdi_2d", interchange::WarpProfile::k2d}, std::pair{"mpcdi_3d", interchange::WarpProfile::k3d},
        std::pair{"mpcdi_a3", interchange::WarpProfile::kAdvanced3d},
        std::pair{"mpcdi_sl", interchange::WarpProfile::kShaderLamps}}) {
    bench.format(
        name, ".mpcdi", [p = profile](GeneratedWarps* made, const Path& path) { return trip_mpcdi(made, path, p); },
        corrupted_mpcdi, [](const Path& path) { return status_of(interchange::read_mpcdi(path)); });
  }
  bench.format("bourke", ".data", trip_bourke, corrupted_bourke,
               [](const Path& path) { return status_of(interchange::read_bourke(path, kAspect)); });
  bench.format("obj", ".obj", trip_obj, corrupted_obj,
               [](const Path& path) { return status_of(interchange::read_warp_obj(path)); });
  bench.format("domeprojection", ".csv", trip_domeprojection, corrupted_csv,
               [](const Path& path) { return status_of(interchange::read_domeprojection(path)); });
  bench.format("simcad", ".simcad", trip_simcad, corrupted_simcad,
               [](const Path& path) { return status_of(interchange::read_simcad(path)); });
  fmt::print("{}\n", bench.results().dump());
  return 0;
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  const auto files = argc == 3 ? cyclorama::parse_integer(argv[1]) : std::nullopt;
  if (!files || *files < 1 || *files > 100000) {
    fmt::print(stderr, "usage: interchange_round_trips FILES_PER_FORMAT FOLDER\n");
    return 2;
  }
  return cyclorama::run(static_cast<int>(*files), argv[2]);
}
