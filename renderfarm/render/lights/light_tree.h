// SPDX-License-Identifier: Apache-2.0
/// Chooses among many lights by estimated contribution, in time logarithmic in their number.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "renderfarm/render/lights/light_lanes.h"

namespace cyclorama::render {

/// A random number in [0, 1) that serves several decisions in turn. It is a double, because the choices among a million
/// lights use up the 24 bits of a float.
class Choice {
 public:
  explicit Choice(double number) : number_(number) {}
  /// Returns true with the given probability.
  bool takes(double probability) {
    if (number_ < probability) {
      number_ /= probability;
      return true;
    }
    number_ = std::min((number_ - probability) / (1.0 - probability), 0x1.fffffffffffffp-1);
    return false;
  }
  [[nodiscard]] double number() const { return number_; }

 private:
  double number_;
};

/// A binary tree of lights, built by a surface-area-and-orientation heuristic. A value; queries are thread-safe.
///
/// Each node stores a bounding box of its lights, a cone of their normals and their power. If a node's importance is
/// zero, none of its lights can shine. Sources: Conty Estevez and Kulla, "Importance Sampling of Many Lights with
/// Adaptive Tree Splitting", 2018; Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th edition, section 12.6.3.
class LightTree {
 public:
  LightTree() = default;
  /// Builds the tree, which takes about 90 bytes per light. Lights without power are left out.
  explicit LightTree(std::span<const LightBounds> lights);

  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  /// Returns an approximate upper bound of the irradiance (luminance) of all lights; 0 if none can shine at `p`. A zero
  /// `n` is a surface lit from both sides.
  [[nodiscard]] float estimate(const Vec3& p, const Vec3& n) const;
  /// Returns the light's index, or -1 if the choice led to lights that cannot shine at `p`.
  [[nodiscard]] int choose(const Vec3& p, const Vec3& n, Choice* choice, float* ret_probability) const;
  /// Returns the probability with which choose() returns `light`; 0 for a light that is left out.
  [[nodiscard]] float probability(const Vec3& p, const Vec3& n, int light) const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::size_t kGroup = 8;
  static constexpr std::size_t kLanes = kGroup / 4;
  static constexpr std::uint32_t kLeaf = 0x80000000u;
  struct Node {
    Vec3 centre;
    Vec3 half;  ///< Half size of the lights' bounding box.
    Vec3 axis;
    float cos_normals;
    float cos_emission;
    float power;
    float inverse_range;
    /// Index of the second child (the first follows its parent), or kLeaf combined with the index of the group.
    std::uint32_t next;
  };
  struct Group {
    std::array<LightLanes, kLanes> lanes;
    std::array<std::uint32_t, kGroup> lights;
    std::uint32_t node;
  };
  struct Item;
  using Estimates = Eigen::Array<float, static_cast<int>(kGroup), 1>;

  [[nodiscard]] static float importance(const Node& node, const Vec3& p, const Vec3& n);
  [[nodiscard]] static Estimates estimates(const Group& group, const Vec3& p, const Vec3& n);
  /// Returns the probability of the first of a node's children; negative if neither can shine.
  [[nodiscard]] float first_share(std::uint32_t node, const Vec3& p, const Vec3& n) const;
  LightBounds build(std::span<Item> items, int depth);
  LightBounds add_group(std::span<const Item> items, std::uint32_t node);
  void set(std::uint32_t node, const LightBounds& bounds, std::uint32_t next);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> parents_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> places_;  ///< Position of each light: kGroup times its group, plus its index in the group.
};

}  // namespace cyclorama::render
