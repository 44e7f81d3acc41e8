// SPDX-License-Identifier: Apache-2.0
/// Random calibrations from a seed: every part that a format can hold, in odd sizes, with unmapped pixels.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include "appliance/interchange/warp_net.h"
#include "appliance/interchange/warp_set.h"

namespace cyclorama {

class GeneratedWarps {
 public:
  explicit GeneratedWarps(std::uint32_t seed) : random_(seed) {}

  /// A smooth, curved map with NaN in a corner: flat within 0 to 1, or some metres around the eye.
  interchange::WarpMap map(int width, int height, bool flat) {
    interchange::WarpMap map(width, height);
    const double bend = number(0.0, 0.1);
    const double phase = number(0.0, 6.0);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double u = (x + 0.5) / width;
        const double v = 1.0 - (y + 0.5) / height;
        float* const sample = map.at(x, y);
        if (u + v < 0.2) {
          for (int i = 0; i < 3; ++i) sample[i] = std::numeric_limits<float>::quiet_NaN();
        } else if (flat) {
          sample[0] = static_cast<float>(0.1 + 0.8 * u + bend * std::sin(3.0 * v + phase));
          sample[1] = static_cast<float>(0.1 + 0.8 * v + bend * std::sin(2.0 * u + phase));
          sample[2] = 0.0f;
        } else {
          const double azimuth = (u - 0.5) * (1.5 + bend);
          sample[0] = static_cast<float>(4.0 * std::sin(azimuth));
          sample[1] = static_cast<float>(3.0 * (v - 0.5) + bend);
          sample[2] = static_cast<float>(-4.0 * std::cos(azimuth));
        }
      }
    }
    return map;
  }

  interchange::MaskMap mask(int width, int height) {
    interchange::MaskMap mask(width, height, count(0, 1) == 0 ? 1 : 3, count(0, 1) == 0 ? 8 : 16);
    for (std::uint16_t& sample : mask.samples) sample = static_cast<std::uint16_t>(count(0, mask.largest()));
    mask.gamma = count(0, 1) == 0 ? 1.0 : 2.2;
    return mask;
  }

  interchange::WarpRegion region(interchange::WarpProfile profile, const std::string& id) {
    const bool in_space =
        profile == interchange::WarpProfile::kAdvanced3d || profile == interchange::WarpProfile::kShaderLamps;
    interchange::WarpRegion region;
    region.id = id;
    region.width_px = count(1, 80);
    region.height_px = count(1, 50);
    region.map = map(region.width_px, region.height_px, !in_space);
    region.interpolation = interchange::WarpInterpolation::kLinear;
    if (in_space) {
      region.unit = count(0, 1) == 0 ? interchange::LengthUnit::kMetre : interchange::LengthUnit::kMillimetre;
      region.origin = profile == interchange::WarpProfile::kShaderLamps ? interchange::DataOrigin::kFloorCentre
                                                                        : interchange::DataOrigin::kIdealEyePoint;
    }
    if (profile == interchange::WarpProfile::k3d || profile == interchange::WarpProfile::kShaderLamps) {
      region.frustum = interchange::WarpFrustum{number(-180, 180), number(-80, 80), number(-30, 30), number(5, 60),
                                                number(-60, -5),   number(5, 40),   number(-40, -5)};
    }
    if (profile == interchange::WarpProfile::kShaderLamps) {
      interchange::WarpCoordinateFrame frame;
      for (double& p : frame.position) p = number(-3.0, 3.0);
      region.coordinate_frame = frame;
      region.distortion = map(count(2, 20), count(2, 20), true);
    }
    if (count(0, 3) > 0) region.alpha = mask(region.width_px, region.height_px);
    if (count(0, 1) == 0) region.beta = mask(count(1, 40), count(1, 40));
    return region;
  }

  interchange::WarpSet set(interchange::WarpProfile profile, interchange::MpcdiVersion version) {
    interchange::WarpSet set;
    set.profile = profile;
    set.version = version;
    set.date = "2024-05-06 07:08:09";
    set.level = count(1, 4);
    set.colour_level = version == interchange::MpcdiVersion::k1_0 ? 1 : count(1, 3);
    interchange::WarpBuffer buffer{"wall <& \"round\">", count(0, 4000), count(0, 2000), {}};
    const int regions = count(1, 3);
    for (int i = 0; i < regions; ++i) {
      interchange::WarpRegion made = region(profile, "Strahler/" + std::to_string(i) + " <ä&>");
      made.rect = {static_cast<double>(i) / regions, 0.0, 1.0 / regions, number(0.1, 1.0)};
      buffer.regions.push_back(std::move(made));
    }
    set.buffers.push_back(std::move(buffer));
    return set;
  }

  /// A curved grid with dimmed and undrawn nodes, in 7 decimals.
  interchange::WarpNet grid() {
    interchange::WarpNet net;
    net.columns = count(2, 30);
    net.rows = count(2, 20);
    for (int j = 0; j < net.rows; ++j) {
      for (int i = 0; i < net.columns; ++i) {
        interchange::WarpNode node{static_cast<double>(i) / (net.columns - 1), static_cast<double>(j) / (net.rows - 1),
                                   number(-0.1, 1.1), number(-0.1, 1.1), count(0, 9) == 0 ? -1.0 : number(0.0, 1.0)};
        node.x += number(-0.01, 0.01);
        net.nodes.push_back(node);
      }
    }
    return net;
  }

  /// The same as triangles, without a grid and at full light.
  interchange::WarpNet triangles() {
    interchange::WarpNet net = grid();
    for (interchange::WarpNode& node : net.nodes) node.light = 1.0;
    net.triangles = net.drawn();
    net.columns = net.rows = 0;
    return net;
  }

  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

 private:
  std::mt19937 random_;
};

}  // namespace cyclorama
