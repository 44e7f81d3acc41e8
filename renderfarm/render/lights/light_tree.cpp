// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cyclorama::render {
namespace {

constexpr std::size_t kBins = 12;
/// Number of lights above which a split considers only the longest axis.
constexpr std::size_t kManyLights = 128;
/// Depth below which nodes are split into halves with equal numbers of lights, whatever the cost. It is reached if
/// positions span many powers of ten.
constexpr int kDeepest = 64;
/// Lower bound of squared distances, in m²: closer lights are no longer distinguished by distance.
constexpr float kMinDistance2 = 1e-6f;
constexpr std::uint32_t kNowhere = 0xffffffffu;

/// Summary of a group of lights, for the cost of a split.
struct Heap {
  Vec3 low = Vec3::Constant(std::numeric_limits<float>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<float>::infinity());
  Vec3 normals = Vec3::Zero();  ///< Sum of the normals: short if they diverge.
  float power = 0.0f;
  float count = 0.0f;

  void add(const Heap& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
    normals += other.normals;
    power += other.power;
    count += other.count;
  }
  /// Returns power x extent x solid angle of emission. The mean of unit normals spread evenly over a cap has the length
  /// (1 + cos) / 2, and the paper's measure of orientation is nearly linear in that cosine, from pi for a plane to 4
  /// pi. The extent is the squared diagonal, because the surface area vanishes for lights in a row.
  [[nodiscard]] float cost() const {
    if (!(count > 0.0f)) return 0.0f;
    const float spread = 1.0f - std::min(1.0f, normals.norm() / count);
    return power * (high - low).squaredNorm() * (1.0f + 3.0f * spread);
  }
};

Heap heap_of(const LightBounds& light) {
  const bool all_around = light.normals.cosine <= -1.0f;
  return {light.low, light.high, all_around ? Vec3(Vec3::Zero()) : light.normals.axis, light.power, 1.0f};
}

}  // namespace

struct LightTree::Item {
  LightBounds bounds;  ///< Stored by value, for locality.
  std::uint32_t light = 0;
  [[nodiscard]] Vec3 place() const { return bounds.centre(); }
};

namespace {

std::size_t bin_of(float place, float low, float inverse_size) {
  const float bin = (place - low) * inverse_size * static_cast<float>(kBins);
  return std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0f, bin)));
}

struct Split {
  int axis = -1;  ///< -1 if no axis separates the lights.
  std::size_t bin = 0;
  float cost = std::numeric_limits<float>::infinity();
};

template <typename Item>
Split best_split(std::span<const Item> items, const Vec3& low, const Vec3& size, int axis) {
  std::array<Heap, kBins> bins;
  for (const Item& item : items) {
    bins[bin_of(item.place()[axis], low[axis], 1.0f / size[axis])].add(heap_of(item.bounds));
  }
  std::array<float, kBins> cost_above{};
  Heap above;
  for (std::size_t i = kBins; i-- > 1;) {
    above.add(bins[i]);
    cost_above[i] = above.cost();
  }
  Split best;
  Heap below;
  const auto all = static_cast<float>(items.size());
  for (std::size_t i = 0; i + 1 < kBins; ++i) {
    below.add(bins[i]);
    if (!(below.count > 0.0f) || below.count >= all) continue;
    // Penalises thin slices, which are worse than their cost suggests.
    const float cost = (below.cost() + cost_above[i + 1]) * (size.maxCoeff() / size[axis]);
    if (cost < best.cost) best = {axis, i, cost};
  }
  return best;
}

}  // namespace

LightTree::LightTree(std::span<const LightBounds> lights) {
  std::vector<Item> items;
  items.reserve(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].power > 0.0f) items.push_back({lights[i], static_cast<std::uint32_t>(i)});
  }
  if (items.empty()) return;
  places_.assign(lights.size(), kNowhere);
  build(items, 0);
  nodes_.shrink_to_fit();
  parents_.shrink_to_fit();
  groups_.shrink_to_fit();
}

void LightTree::set(std::uint32_t node, const LightBounds& bounds, std::uint32_t next) {
  // Rounding may leave a corner slightly outside the box around the centre.
  constexpr float kRoundings = 4.0f * 0x1p-24f;
  const Vec3 centre = bounds.centre();
  const Vec3 slack = kRoundings * bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs());
  nodes_[node] = {centre,
                  0.5f * (bounds.high - bounds.low) + slack,
                  bounds.normals.axis,
                  bounds.normals.cosine,
                  bounds.cos_emission,
                  bounds.power,
                  bounds.inverse_range,
                  next};
}

LightBounds LightTree::add_group(std::span<const Item> items, std::uint32_t node) {
  LightBounds bounds;
  Group group;
  group.node = node;
  group.lights.fill(kNowhere);
  for (std::size_t i = 0; i < items.size(); ++i) {
    bounds.extend(items[i].bounds);
    group.lanes[i / 4].set(i % 4, items[i].bounds);
    group.lights[i] = items[i].light;
    places_[items[i].light] = static_cast<std::uint32_t>(groups_.size() * kGroup + i);
  }
  set(node, bounds, kLeaf | static_cast<std::uint32_t>(groups_.size()));
  groups_.push_back(group);
  return bounds;
}

LightBounds LightTree::build(std::span<Item> items, int depth) {
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  parents_.push_back(kNowhere);
  if (items.size() <= kGroup) return add_group(items, node);
  Vec3 low = items[0].place();
  Vec3 high = low;
  for (const Item& item : items) {
    low = low.cwiseMin(item.place());
    high = high.cwiseMax(item.place());
  }
  const Vec3 size = high - low;
  int longest = 0;
  size.maxCoeff(&longest);
  Split split;
  for (int axis = 0; axis < 3 && depth < kDeepest; ++axis) {
    if (!std::isnormal(size[axis]) || (items.size() > kManyLights && axis != longest)) continue;
    const Split other = best_split(std::span<const Item>(items), low, size, axis);
    if (other.cost < split.cost) split = other;
  }
  std::size_t half = items.size() / 2;
  if (split.axis >= 0) {
    const auto is_below = [&](const Item& item) {
      return bin_of(item.place()[split.axis], low[split.axis], 1.0f / size[split.axis]) <= split.bin;
    };
    half = static_cast<std::size_t>(std::partition(items.begin(), items.end(), is_below) - items.begin());
  } else {
    const auto less = [longest](const Item& a, const Item& b) { return a.place()[longest] < b.place()[longest]; };
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(), less);
  }
  LightBounds bounds = build(items.first(half), depth + 1);
  const auto second = static_cast<std::uint32_t>(nodes_.size());
  bounds.extend(build(items.subspan(half), depth + 1));
  parents_[node + 1] = node;
  parents_[second] = node;
  set(node, bounds, second);
  return bounds;
}

float LightTree::importance(const Node& node, const Vec3& p, const Vec3& n) {
  const Vec3 offset = node.centre - p;
  const float distance2 = offset.squaredNorm();
  const float radius2 = node.half.squaredNorm();
  const float near2 = std::max({distance2, radius2, kMinDistance2});
  float strength = node.power / near2;
  if (!n.isZero(0.0f)) {
    // Greatest height of the box's corners above the horizon.
    const float highest = n.dot(offset) + n.cwiseAbs().dot(node.half);
    if (!(highest > 0.0f)) return 0.0f;
    strength *= std::min(1.0f, highest / std::sqrt(near2));
  }
  if (distance2 <= radius2 || !(distance2 > 0.0f)) return strength;
  const float distance = std::sqrt(distance2);
  const float radius = std::sqrt(radius2);
  const float part = std::max(0.0f, distance - radius) * node.inverse_range;
  const float part2 = part * part;
  const float fade = 1.0f - part2 * part2;
  if (!(fade > 0.0f)) return 0.0f;
  strength *= fade;

  const float cosine = -node.axis.dot(offset) / distance;
  if (cosine >= node.cos_normals) return strength;
  // Angle to the axis minus the cone's half angle, minus the half angle that the box subtends at p.
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  const float sin_normals = std::sqrt(std::max(0.0f, 1.0f - node.cos_normals * node.cos_normals));
  const float cos_left = cosine * node.cos_normals + sine * sin_normals;
  const float sin_left = sine * node.cos_normals - cosine * sin_normals;
  const float sin_b = radius / distance;
  const float cos_b = std::sqrt(std::max(0.0f, 1.0f - sin_b * sin_b));
  const float emitted = cos_left >= cos_b ? 1.0f : cos_left * cos_b + sin_left * sin_b;
  return emitted > node.cos_emission ? strength * emitted : 0.0f;
}

float LightTree::estimate(const Vec3& p, const Vec3& n) const {
  return nodes_.empty() ? 0.0f : importance(nodes_.front(), p, n);
}

LightTree::Estimates LightTree::estimates(const Group& group, const Vec3& p, const Vec3& n) {
  Estimates all;
  for (std::size_t i = 0; i < kLanes; ++i)
    all.segment<4>(static_cast<Eigen::Index>(4 * i)) = group.lanes[i].estimate(p, n);
  return all;
}

float LightTree::first_share(std::uint32_t node, const Vec3& p, const Vec3& n) const {
  const float first = importance(nodes_[node + 1], p, n);
  const float both = first + importance(nodes_[nodes_[node].next], p, n);
  return both > 0.0f && std::isfinite(both) ? first / both : -1.0f;
}

int LightTree::choose(const Vec3& p, const Vec3& n, Choice* choice, float* ret_probability) const {
  if (nodes_.empty()) return -1;
  std::uint32_t node = 0;
  float probability = 1.0f;
  while ((nodes_[node].next & kLeaf) == 0) {
    const float share = first_share(node, p, n);
    if (share < 0.0f) return -1;
    const bool is_first = choice->takes(static_cast<double>(share));
    probability *= is_first ? share : 1.0f - share;
    node = is_first ? node + 1 : nodes_[node].next;
  }
  const Group& group = groups_[nodes_[node].next & ~kLeaf];
  const Estimates all = estimates(group, p, n);
  const float sum = all.sum();
  if (!(sum > 0.0f) || !std::isfinite(sum)) return -1;
  double left = choice->number() * static_cast<double>(sum);
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < kGroup; ++i) {
    const float estimate = all[static_cast<Eigen::Index>(i)];
    if (!(estimate > 0.0f)) continue;
    chosen = i;
    left -= static_cast<double>(estimate);
    if (left < 0.0) break;
  }
  *ret_probability = probability * (all[static_cast<Eigen::Index>(chosen)] / sum);
  return *ret_probability > 0.0f ? static_cast<int>(group.lights[chosen]) : -1;
}

float LightTree::probability(const Vec3& p, const Vec3& n, int light) const {
  const std::uint32_t place = places_[static_cast<std::size_t>(light)];
  if (place == kNowhere) return 0.0f;
  const Group& group = groups_[place / kGroup];
  const Estimates all = estimates(group, p, n);
  const float sum = all.sum();
  if (!(sum > 0.0f) || !std::isfinite(sum)) return 0.0f;
  float probability = all[static_cast<Eigen::Index>(place % kGroup)] / sum;
  std::uint32_t node = group.node;
  while (node != 0 && probability > 0.0f) {
    const std::uint32_t parent = parents_[node];
    const float share = first_share(parent, p, n);
    if (share < 0.0f) return 0.0f;
    probability *= node == parent + 1 ? share : 1.0f - share;
    node = parent;
  }
  return probability;
}

std::size_t LightTree::bytes() const {
  return nodes_.capacity() * sizeof(Node) + groups_.capacity() * sizeof(Group) +
         (parents_.capacity() + places_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace cyclorama::render
