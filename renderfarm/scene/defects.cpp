// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/defects.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>
#include <utility>

#include "renderfarm/scene/mesh_topology.h"

namespace cyclorama::scene {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr std::size_t kMaxExamined = 20'000'000;
constexpr std::size_t kMaxLargest = 3;
constexpr double kMaxHole = 0.25;           ///< Share of the surface's diagonal.
constexpr double kSliver = 1e-3;            ///< Width over length.
constexpr std::size_t kMaxSheets = 20'000;  ///< The search for what is inside out compares each with all others.
constexpr double kMinInsideM = 3.0;
constexpr std::size_t kMinScan = 1000;        ///< Triangles of a surface beside which small parts are debris.
constexpr double kMinScanArea = 0.5;          ///< Its share of all area.
constexpr double kMaxDebrisSize = 0.03;       ///< Share of the scan's diagonal.
constexpr double kMaxDebrisArea = 0.01;       ///< Share of the scan's area.
constexpr double kMaxDebrisTriangles = 0.05;  ///< Share of all triangles; more is a part of the work.

/// The triangles of a model, what hangs together, and what each triangle suffers from.
struct Examined {
  struct Source {
    std::uint32_t mesh, triangle;
  };
  TriangleSoup soup;
  std::vector<Source> sources;  ///< One per triangle.
  Topology topology;
  std::vector<AlignedBox3d> boxes;                  ///< One per sheet.
  std::vector<std::optional<DefectKind>> of_sheet;  ///< kInsideOut or kDebris.
  Vector3d origin = Vector3d::Zero();               ///< Subtracted from all places.

  [[nodiscard]] std::optional<DefectKind> of_triangle(std::size_t i) const {
    const std::uint32_t sheet = topology.sheet_of[i];
    if (!topology.has_area[i]) return DefectKind::kNoArea;
    if (of_sheet[sheet] == DefectKind::kDebris) return DefectKind::kDebris;
    if (topology.sheets[sheet].twisted) return std::nullopt;
    const bool inside_out = of_sheet[sheet] == DefectKind::kInsideOut;
    if (inside_out != topology.is_turned[i]) return inside_out ? DefectKind::kInsideOut : DefectKind::kTurned;
    return std::nullopt;
  }
};

/// Numbers places so that equal ones have the same number.
class PlaceNumbers {
 public:
  /// Rounding of float coordinates must not tear neighbouring meshes apart.
  explicit PlaceNumbers(double diagonal) : step_(std::max(diagonal, 1e-12) / (1 << 20)) {}

  std::vector<std::uint32_t> number(const std::vector<Vector3d>& all, std::vector<Vector3d>* ret_places) const {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    order.reserve(all.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) order.emplace_back(key_of(all[i]), i);
    std::ranges::sort(order);
    std::vector<std::uint32_t> numbers(all.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i == 0 || order[i].first != order[i - 1].first) ret_places->push_back(all[order[i].second]);
      numbers[order[i].second] = static_cast<std::uint32_t>(ret_places->size() - 1);
    }
    return numbers;
  }

 private:
  [[nodiscard]] std::uint64_t key_of(const Vector3d& p) const {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kMiddle = 1 << 20;
      key = key << 21 | static_cast<std::uint64_t>(std::clamp(std::round(p[axis] / step_) + kMiddle, 0.0, 2097151.0));
    }
    return key;
  }
  double step_;
};

/// Returns the surfaces of a model, each mesh where it is placed first.
void gather(const Model& model, Examined* ret_examined) {
  std::vector<const Instance*> placed(model.meshes.size(), nullptr);
  for (const Instance& instance : model.instances) {
    const Instance*& first = placed[static_cast<std::size_t>(instance.mesh)];
    if (first == nullptr) first = &instance;
  }
  std::vector<Vector3d> corners;
  AlignedBox3d box;
  for (std::uint32_t m = 0; m < model.meshes.size(); ++m) {
    if (placed[m] == nullptr) continue;
    const Mesh& mesh = model.meshes[m];
    const auto first = static_cast<std::uint32_t>(corners.size());
    for (const std::array<float, 3>& p : mesh.positions) {
      corners.push_back(placed[m]->T_model_mesh * (mesh.origin + Vector3d(double{p[0]}, double{p[1]}, double{p[2]})));
      box.extend(corners.back());
    }
    const bool mirrored = placed[m]->T_model_mesh.linear().determinant() < 0.0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      auto [a, b, c] = mesh.triangles[t];
      if (mirrored) std::swap(b, c);
      ret_examined->soup.triangles.push_back({first + a, first + b, first + c});
      ret_examined->sources.push_back({m, t});
    }
  }
  if (box.isEmpty()) return;
  ret_examined->origin = box.center();
  for (Vector3d& corner : corners) corner -= ret_examined->origin;
  const std::vector<std::uint32_t> numbers =
      PlaceNumbers(box.diagonal().norm()).number(corners, &ret_examined->soup.places);
  for (auto& triangle : ret_examined->soup.triangles) {
    for (std::uint32_t& corner : triangle) corner = numbers[corner];
  }
}

/// The cells of a grid that triangles touch.
class TouchedCells {
 public:
  explicit TouchedCells(double cell) : cell_(cell) {}

  void add(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    constexpr int kMaxSteps = 512;
    const double longest = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
    const int steps = static_cast<int>(std::min<double>(kMaxSteps, std::ceil(longest / cell_)));
    for (int i = 0; i <= steps; ++i) {
      for (int k = 0; i + k <= steps; ++k) {
        const double n = std::max(steps, 1);
        cells_.insert(key_of(a + (b - a) * (i / n) + (c - a) * (k / n)));
      }
    }
  }
  [[nodiscard]] bool touches(const AlignedBox3d& box) const {
    const Vector3d first = box.min() - Vector3d::Constant(cell_);
    const Eigen::Vector3i steps = ((box.max() - first + Vector3d::Constant(cell_)) / cell_).array().floor().cast<int>();
    for (int x = 0; x <= steps.x(); ++x) {
      for (int y = 0; y <= steps.y(); ++y) {
        for (int z = 0; z <= steps.z(); ++z) {
          if (cells_.contains(key_of(first + cell_ * Vector3d(x, y, z)))) return true;
        }
      }
    }
    return false;
  }

 private:
  [[nodiscard]] std::uint64_t key_of(const Vector3d& p) const {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      key = key << 21 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(p[axis] / cell_))) & 0x1fffff);
    }
    return key;
  }
  double cell_;
  std::unordered_set<std::uint64_t> cells_;
};

void find_debris(Examined* examined) {
  const std::vector<Sheet>& sheets = examined->topology.sheets;
  const auto scan = std::ranges::max_element(sheets, {}, &Sheet::area);
  double area = 0.0;
  for (const Sheet& sheet : sheets) area += sheet.area;
  if (scan == sheets.end() || scan->triangles < kMinScan || scan->area < kMinScanArea * area) return;
  const double scan_size = examined->boxes[static_cast<std::size_t>(scan - sheets.begin())].diagonal().norm();
  std::vector<std::uint32_t> small;
  std::vector<bool> is_small(sheets.size(), false);
  double cell = scan_size / 512.0;
  for (std::uint32_t s = 0; s < sheets.size(); ++s) {
    const double size = examined->boxes[s].diagonal().norm();
    if (size > kMaxDebrisSize * scan_size || sheets[s].area > kMaxDebrisArea * scan->area) continue;
    small.push_back(s);
    is_small[s] = true;
    cell = std::max(cell, size);
  }
  if (small.empty() || !(cell > 0.0)) return;
  TouchedCells touched(cell);
  for (std::size_t i = 0; i < examined->soup.triangles.size(); ++i) {
    const std::uint32_t sheet = examined->topology.sheet_of[i];
    if (sheet == kNoSheet || is_small[sheet]) continue;
    const auto& [a, b, c] = examined->soup.triangles[i];
    touched.add(examined->soup.places[a], examined->soup.places[b], examined->soup.places[c]);
  }
  std::vector<std::uint32_t> floating;
  std::size_t triangles = 0;
  for (const std::uint32_t s : small) {
    if (touched.touches(examined->boxes[s])) continue;
    floating.push_back(s);
    triangles += sheets[s].triangles;
  }
  if (static_cast<double>(triangles) > kMaxDebrisTriangles * static_cast<double>(examined->sources.size())) return;
  for (const std::uint32_t s : floating) examined->of_sheet[s] = DefectKind::kDebris;
}

void find_inside_out(Examined* examined) {
  const std::vector<Sheet>& sheets = examined->topology.sheets;
  if (sheets.size() > kMaxSheets) return;
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    if (examined->of_sheet[s] || !sheets[s].closed || sheets[s].twisted || !(sheets[s].volume < 0.0)) continue;
    // The inside of a hollow thing faces inwards, and so does a room, which is seen from within.
    if (examined->boxes[s].diagonal().norm() > kMinInsideM) continue;
    bool is_within = false;
    for (std::size_t other = 0; other < sheets.size() && !is_within; ++other) {
      is_within = other != s && examined->boxes[other].contains(examined->boxes[s]);
    }
    bool holds = false;
    for (std::size_t other = 0; other < sheets.size() && !holds; ++other) {
      holds = other != s && examined->boxes[s].contains(examined->boxes[other]);
    }
    if (!is_within && !holds) examined->of_sheet[s] = DefectKind::kInsideOut;
  }
}

Examined examine(const Model& model) {
  Examined examined;
  gather(model, &examined);
  examined.topology = topology_of(examined.soup);
  examined.boxes.resize(examined.topology.sheets.size());
  examined.of_sheet.resize(examined.topology.sheets.size());
  for (std::size_t i = 0; i < examined.soup.triangles.size(); ++i) {
    const std::uint32_t sheet = examined.topology.sheet_of[i];
    if (sheet == kNoSheet) continue;
    for (const std::uint32_t corner : examined.soup.triangles[i]) {
      examined.boxes[sheet].extend(examined.soup.places[corner]);
    }
  }
  find_debris(&examined);
  find_inside_out(&examined);
  return examined;
}

bool is_too_large(const Model& model) {
  std::size_t triangles = 0;
  for (const Mesh& mesh : model.meshes) triangles += mesh.triangles.size();
  return triangles > kMaxExamined;
}

/// Collects defects: counts all, keeps the largest.
class DefectList {
 public:
  explicit DefectList(const Examined& examined) : examined_(examined) {}

  void add(DefectKind kind, const AlignedBox3d& box, const Vector3d& facing, std::size_t triangles) {
    Defects::Count& count = found_.counts[static_cast<std::size_t>(kind)];
    ++count.places;
    count.triangles += triangles;
    const double length = facing.norm();
    of_kind_[static_cast<std::size_t>(kind)].push_back({kind, box.center() + examined_.origin,
                                                        length > 0.0 ? Vector3d(facing / length) : Vector3d::UnitY(),
                                                        box.diagonal().norm()});
    auto& kept = of_kind_[static_cast<std::size_t>(kind)];
    std::ranges::stable_sort(kept, std::greater(), &Defect::size_m);
    if (kept.size() > kMaxLargest) kept.pop_back();
  }
  [[nodiscard]] Defects take() && {
    for (auto& kept : of_kind_) found_.largest.insert(found_.largest.end(), kept.begin(), kept.end());
    return std::move(found_);
  }

 private:
  const Examined& examined_;
  Defects found_;
  std::array<std::vector<Defect>, kDefectKinds.size()> of_kind_;
};

void add_holes(const Examined& examined, DefectList* list) {
  for (const Rim& rim : examined.topology.rims) {
    if (rim.corners.size() < 3 || examined.of_sheet[rim.sheet] == DefectKind::kDebris) continue;
    AlignedBox3d box;
    Vector3d facing = Vector3d::Zero();  // Newell's normal; triangles pass the rim of a hole the other way around.
    for (std::size_t i = 0; i < rim.corners.size(); ++i) {
      const Vector3d& p = examined.soup.places[rim.corners[i]];
      box.extend(p);
      facing -= p.cross(examined.soup.places[rim.corners[(i + 1) % rim.corners.size()]]);
    }
    if (box.diagonal().norm() > kMaxHole * examined.boxes[rim.sheet].diagonal().norm()) continue;
    list->add(DefectKind::kHole, box, facing, rim.corners.size());
  }
}

/// Adds defects of whole sheets, and of the triangles in them.
void add_triangles(const Examined& examined, DefectList* list) {
  const auto box_of = [&](std::size_t i) {
    AlignedBox3d box;
    for (const std::uint32_t corner : examined.soup.triangles[i]) box.extend(examined.soup.places[corner]);
    return box;
  };
  std::vector<AlignedBox3d> boxes(examined.boxes.size());
  std::vector<Vector3d> facings(examined.boxes.size(), Vector3d::Zero());
  std::vector<std::size_t> counts(examined.boxes.size(), 0);
  for (std::size_t i = 0; i < examined.soup.triangles.size(); ++i) {
    const std::optional<DefectKind> kind = examined.of_triangle(i);
    const auto& [a, b, c] = examined.soup.triangles[i];
    const Vector3d ab = examined.soup.places[b] - examined.soup.places[a];
    const Vector3d ac = examined.soup.places[c] - examined.soup.places[a];
    const Vector3d normal = ab.cross(ac);
    if (kind == DefectKind::kNoArea) {
      list->add(*kind, box_of(i), normal, 1);
    } else if (kind) {
      const std::uint32_t sheet = examined.topology.sheet_of[i];
      boxes[sheet].extend(box_of(i));
      facings[sheet] += kind == DefectKind::kDebris ? normal : Vector3d(-normal);
      ++counts[sheet];
    } else {
      const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
      if (normal.norm() < kSliver * longest * longest) list->add(DefectKind::kSliver, box_of(i), normal, 1);
    }
  }
  for (std::size_t s = 0; s < counts.size(); ++s) {
    if (counts[s] == 0) continue;
    list->add(examined.of_sheet[s].value_or(DefectKind::kTurned), boxes[s], facings[s], counts[s]);
  }
}

}  // namespace

std::string_view name_of(DefectKind kind) {
  switch (kind) {
    case DefectKind::kHole:
      return "holes";
    case DefectKind::kTurned:
      return "turned triangles";
    case DefectKind::kInsideOut:
      return "surfaces inside out";
    case DefectKind::kDebris:
      return "floating debris";
    case DefectKind::kNoArea:
      return "triangles without area";
    case DefectKind::kSliver:
      return "slivers";
  }
  return "";
}

bool is_mended(DefectKind kind) { return kind != DefectKind::kHole && kind != DefectKind::kSliver; }

Defects find_defects(const Model& model) {
  if (is_too_large(model)) {
    Defects none;
    none.is_examined = false;
    return none;
  }
  const Examined examined = examine(model);
  DefectList list(examined);
  add_holes(examined, &list);
  add_triangles(examined, &list);
  return std::move(list).take();
}

std::vector<std::string> repair_defects(Model* model) {
  if (is_too_large(*model)) return {"there are too many triangles to look for what is broken: nothing is mended"};
  const Examined examined = examine(*model);
  std::array<std::size_t, kDefectKinds.size()> mended{};
  std::vector<std::vector<bool>> gone(model->meshes.size());
  for (std::size_t i = 0; i < examined.sources.size(); ++i) {
    const std::optional<DefectKind> kind = examined.of_triangle(i);
    if (!kind) continue;
    ++mended[static_cast<std::size_t>(*kind)];
    const auto [mesh, triangle] = examined.sources[i];
    std::array<std::uint32_t, 3>& corners = model->meshes[mesh].triangles[triangle];
    if (*kind == DefectKind::kTurned || *kind == DefectKind::kInsideOut) {
      std::swap(corners[1], corners[2]);
    } else {
      gone[mesh].resize(model->meshes[mesh].triangles.size(), false);
      gone[mesh][triangle] = true;
    }
  }
  for (std::size_t m = 0; m < gone.size(); ++m) {
    if (gone[m].empty()) continue;
    std::size_t at = 0;
    std::erase_if(model->meshes[m].triangles, [&](const auto&) { return gone[m][at++]; });
  }
  std::vector<std::string> notes;
  for (const DefectKind kind : kDefectKinds) {
    const std::size_t count = mended[static_cast<std::size_t>(kind)];
    if (count > 0) notes.push_back(fmt::format("repaired: {} ({} triangles)", name_of(kind), count));
  }
  return notes;
}

}  // namespace cyclorama::scene
