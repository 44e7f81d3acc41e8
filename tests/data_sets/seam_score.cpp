// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "tests/data_sets/photometry_museum.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStep_deg = 0.1;
constexpr int kAside = 4;  // Steps from the two samples beside the border: 0.45 degrees from it.
constexpr int kFar = 9;    // 0.95 degrees.
constexpr double kMaskGoal = 0.005;
constexpr std::array<double, 4> kContents = {1.0, 0.2, 0.02, 0.0};
const Eigen::Vector3d kLuminance{0.2126, 0.7152, 0.0722};  // ITU-R BT.709.

Eigen::Vector3d as_vector(const simulated::RoomColour& colour) { return {colour[0], colour[1], colour[2]}; }

template <int Channels>
std::array<double, std::size_t{Channels}> bilinear(const Image<float, Channels>& image, const Eigen::Vector2d& pixel) {
  const double x = std::clamp(pixel.x() - 0.5, 0.0, image.width() - 1.001);
  const double y = std::clamp(pixel.y() - 0.5, 0.0, image.height() - 1.001);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  std::array<double, std::size_t{Channels}> result{};
  for (int corner = 0; corner < 4; ++corner) {
    const double part = (corner % 2 == 0 ? 1.0 - (x - x0) : x - x0) * (corner / 2 == 0 ? 1.0 - (y - y0) : y - y0);
    const float* value = image.at(x0 + corner % 2, y0 + corner / 2);
    for (std::size_t c = 0; c < result.size(); ++c) result.at(c) += part * static_cast<double>(value[c]);
  }
  return result;
}

/// The wall with one linear grey, as its heads show it: fractional code values, as produced by dithering.
class ShownWall {
 public:
  ShownWall(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry, double content,
            bool uses_photometry)
      : museum_(museum) {
    std::vector<RgbImage> rounded;
    for (const photometry::PhotometricHead& head : photometry.heads) {
      const warp::MaskImage all(head.mask.width(), head.mask.height(), 1.0f);
      const warp::MaskImage& mask = uses_photometry ? head.mask : all;
      const warp::HeadColour plain;
      const warp::HeadColour& colour = uses_photometry ? head.colour : plain;
      Image<float, 3> codes(mask.width(), mask.height());
      RgbImage whole(mask.width(), mask.height());
      for (int y = 0; y < mask.height(); ++y) {
        for (int x = 0; x < mask.width(); ++x) {
          const double black_lift = colour.black_lift ? static_cast<double>(*colour.black_lift->at(x, y)) : 0.0;
          const double masked = content * static_cast<double>(*mask.at(x, y));
          const Eigen::Vector3d code =
              warp::codes_of(colour, warp::shone_light(colour, Eigen::Vector3d::Constant(masked), black_lift));
          for (int c = 0; c < 3; ++c) {
            codes.at(x, y)[c] = static_cast<float>(255.0 * code[c]);
            whole.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(255.0 * code[c]));
          }
        }
      }
      codes_.push_back(std::move(codes));
      rounded.push_back(std::move(whole));
    }
    add_indirect(rounded);
  }

  /// Radiance towards the eye in linear room colour.
  [[nodiscard]] Eigen::Vector3d at(const simulated::TrueWall::Hit& hit) const {
    Eigen::Vector3d lux = as_vector(museum_.truth().ambient_lux);
    for (std::size_t p = 0; p < codes_.size(); ++p) {
      const auto pixel = museum_.projector_pixel(p, hit);
      if (!pixel || !museum_.truth().projectors[p].lens.pinhole().contains(*pixel)) continue;
      const auto codes = bilinear(codes_[p], *pixel);
      Eigen::Vector3d colour = Eigen::Vector3d::Zero();
      for (std::size_t c = 0; c < 3; ++c) {
        const int low = std::clamp(static_cast<int>(codes.at(c)), 0, 254);
        const double part = codes.at(c) - low;
        const double light =
            (1.0 - part) * museum_.channel_light(p, c, low) + part * museum_.channel_light(p, c, low + 1);
        colour += light * as_vector(museum_.truth().projectors[p].primaries.at(c));
      }
      lux += museum_.gain_lux(p, hit) * colour;
    }
    if (!indirect_.empty()) {
      const simulated::WallCells::Share share = museum_.cells().share(hit.position);
      for (std::size_t k = 0; k < 4; ++k) lux += share.weights.at(k) * as_vector(indirect_[share.cells.at(k)]);
    }
    return lux.cwiseProduct(as_vector(museum_.truth().albedo)) / std::numbers::pi;
  }

 private:
  void add_indirect(const std::vector<RgbImage>& pictures) {
    const simulated::InterReflection* const walls = museum_.inter_reflection();
    if (walls == nullptr) return;
    simulated::InterReflection::Light light(museum_.cells().count(), museum_.truth().ambient_lux);
    for (std::size_t p = 0; p < pictures.size(); ++p) {
      const auto direct = museum_.direct_light(p, pictures[p]);
      for (std::size_t k = 0; k < light.size(); ++k) {
        for (std::size_t r = 0; r < 3; ++r) light[k].at(r) += direct[k].at(r);
      }
    }
    indirect_ = walls->indirect(light);
  }

  const simulated::TrueMuseum& museum_;
  std::vector<Image<float, 3>> codes_;
  simulated::InterReflection::Light indirect_;
};

/// Returns CIE 1976 L*a*b* of linear BT.709 light, relative to a white of the same kind.
Eigen::Vector3d lab_of(const Eigen::Vector3d& light, const Eigen::Vector3d& white) {
  Eigen::Matrix3d to_xyz;
  to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
  const Eigen::Vector3d ratio = (to_xyz * light).cwiseQuotient(to_xyz * white);
  const double fy = f(ratio.y());
  return {116.0 * fy - 16.0, 500.0 * (f(ratio.x()) - fy), 200.0 * (fy - f(ratio.z()))};
}

double percentile(std::vector<double> values, double part) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double mean(const std::vector<double>& values) {
  return values.empty() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// A sample on a scan line, and the projectors whose pictures contain it.
struct SeamSample {
  std::optional<simulated::TrueWall::Hit> hit;
  unsigned projectors = 0;
  double weights = 0.0;  ///< Sum over all of them.
  Eigen::Vector2d at_deg = Eigen::Vector2d::Zero();
};

/// The samples from which one side of a border is extrapolated, and their distances from it.
struct Side {
  std::vector<simulated::TrueWall::Hit> hits;
  std::vector<double> from_deg;
};

struct Pairs {
  std::vector<std::pair<simulated::TrueWall::Hit, simulated::TrueWall::Hit>> borders;
  std::vector<std::pair<Side, Side>> sides;
  std::vector<SeamScore::Border> told;
  struct Bump {
    simulated::TrueWall::Hit before, middle, behind;
    double part;
  };
  std::vector<Bump> bumps;
};

/// Collects the samples from `neighbour`, which is beside the border, in the direction `way` (1 or -1), as long as the
/// same projectors light them.
Side side_of(const std::vector<SeamSample>& line, std::size_t neighbour, int way) {
  const auto at = [&](int step) { return static_cast<std::size_t>(static_cast<int>(neighbour) + way * step); };
  const auto is_same = [&](int step) {
    return at(step) < line.size() && line[at(step)].hit && line[at(step)].projectors == line[neighbour].projectors;
  };
  int last = kAside;
  while (last < kFar && is_same(last + 1)) ++last;
  Side side;
  for (int step = last > kAside + 2 ? kAside : 0; step <= last; ++step) {
    side.hits.push_back(*line[at(step)].hit);
    side.from_deg.push_back((step + 0.5) * kStep_deg);
  }
  return side;
}

/// Value at the border of a straight line through the samples of a side, and its slope.
struct Continued {
  double value;
  double per_deg;
};
Continued continued(const Side& side, const std::vector<double>& values) {
  const double x = mean(side.from_deg);
  const double y = mean(values);
  double over = 0.0;
  double under = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    over += (side.from_deg[i] - x) * (values[i] - y);
    under += (side.from_deg[i] - x) * (side.from_deg[i] - x);
  }
  return {y - over / under * x, over / under};
}

void add_line(const std::vector<SeamSample>& line, bool is_upwards, Pairs* pairs) {
  const auto is_even = [&line](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i <= last; ++i) {
      if (!line[i].hit || line[i].projectors != line[first].projectors || line[i].projectors == 0) return false;
    }
    return true;
  };
  std::optional<std::size_t> opened;
  for (std::size_t i = kAside; i + 1 + kAside < line.size(); ++i) {
    if (line[i].projectors == line[i + 1].projectors) continue;
    const bool is_border = is_even(i - kAside, i) && is_even(i + 1, i + 1 + kAside);
    if (is_border) {
      pairs->borders.emplace_back(*line[i - kAside].hit, *line[i + 1 + kAside].hit);
      pairs->sides.emplace_back(side_of(line, i, -1), side_of(line, i + 1, 1));
      pairs->told.push_back({line[i].at_deg, is_upwards, line[i].projectors, line[i + 1].projectors});
    }
    const bool is_overlap = std::popcount(line[i + 1].projectors) > std::popcount(line[i].projectors);
    if (opened && is_border && !is_overlap) {
      const std::size_t before = *opened - kAside;
      const std::size_t behind = i + 1 + kAside;
      const std::size_t middle = (before + behind) / 2;
      pairs->bumps.push_back({*line[before].hit, *line[middle].hit, *line[behind].hit,
                              static_cast<double>(middle - before) / static_cast<double>(behind - before)});
    }
    opened = is_border && is_overlap ? std::optional(i) : std::nullopt;
  }
}

}  // namespace

SeamScore seam_score(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry,
                     bool uses_photometry, double rim_deg) {
  SeamScore score;
  std::size_t shared = 0;
  std::size_t off = 0;
  Pairs pairs;
  const auto view_direction_of = [&](double azimuth_deg, double elevation_deg) {
    const double azimuth = azimuth_deg * kDegree;
    const double elevation = elevation_deg * kDegree;
    const Eigen::Vector3d direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                    -std::cos(azimuth) * std::cos(elevation));
    SeamSample sample;
    sample.at_deg = {azimuth_deg, elevation_deg};
    sample.hit = museum.wall().hit({museum.installation().sweet_spot, direction});
    if (!sample.hit) return sample;
    for (std::size_t p = 0; p < photometry.heads.size(); ++p) {
      const auto pixel = museum.projector_pixel(p, *sample.hit);
      if (!pixel || !museum.truth().projectors[p].lens.pinhole().contains(*pixel)) continue;
      sample.projectors |= 1u << p;
      sample.weights += bilinear(photometry.heads[p].weight, *pixel)[0];
    }
    return sample;
  };
  const auto is_lit = [&](const Eigen::Vector2d& at_deg) {
    return view_direction_of(at_deg.x(), at_deg.y()).projectors != 0;
  };
  const auto judge_weights = [&](const std::vector<SeamSample>& line) {
    for (const SeamSample& sample : line) {
      const double error = std::abs(sample.weights - 1.0);
      if (std::popcount(sample.projectors) < 2) continue;
      ++shared;
      off += static_cast<std::size_t>(error > kMaskGoal);
      if (!(error > score.mask_sum_error)) continue;
      score.mask_sum_error_rim = std::max(score.mask_sum_error_rim, error);
      bool is_inside = true;
      for (int way = 0; way < 8 && is_inside; ++way) {
        const double turn = way * 45.0 * kDegree;
        is_inside = is_lit(sample.at_deg + rim_deg * Eigen::Vector2d(std::cos(turn), std::sin(turn)));
      }
      if (!is_inside) continue;
      score.mask_sum_error = error;
      score.mask_worst_deg = sample.at_deg;
    }
  };
  for (double elevation = -60.0; elevation <= 80.0; elevation += 1.7) {
    std::vector<SeamSample> line;
    for (double azimuth = -110.0; azimuth <= 110.0; azimuth += kStep_deg)
      line.push_back(view_direction_of(azimuth, elevation));
    add_line(line, false, &pairs);
    judge_weights(line);
  }
  for (double azimuth = -105.0; azimuth <= 105.0; azimuth += 3.3) {
    std::vector<SeamSample> line;
    for (double elevation = -60.0; elevation <= 80.0; elevation += kStep_deg)
      line.push_back(view_direction_of(azimuth, elevation));
    add_line(line, true, &pairs);
    judge_weights(line);
  }
  score.mask_off = static_cast<double>(off) / static_cast<double>(std::max<std::size_t>(1, shared));
  score.pairs = pairs.borders.size();
  Eigen::Vector3d white = Eigen::Vector3d::Zero();
  std::vector<double> steps;
  std::vector<double> jumps;
  std::vector<double> bumps;
  std::vector<double> all;
  for (const double content : kContents) {
    const ShownWall wall(museum, photometry, content, uses_photometry);
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> seen;
    for (const auto& [a, b] : pairs.borders) seen.emplace_back(wall.at(a), wall.at(b));
    if (content == 1.0) {
      for (const auto& [a, b] : seen) {
        for (const Eigen::Vector3d& colour : {a, b}) {
          if (kLuminance.dot(colour) > kLuminance.dot(white)) white = colour;
        }
        const double ya = kLuminance.dot(a);
        const double yb = kLuminance.dot(b);
        steps.push_back(2.0 * std::abs(ya - yb) / (ya + yb));
        SeamScore::Border& told = pairs.told[steps.size() - 1];
        const auto& [before, behind] = pairs.sides[steps.size() - 1];
        const auto line = [&](const Side& side) {
          std::vector<double> values;
          for (const simulated::TrueWall::Hit& hit : side.hits)
            values.push_back(2.0 * kLuminance.dot(wall.at(hit)) / (ya + yb));
          return continued(side, values);
        };
        const Continued from = line(before);
        const Continued to = line(behind);
        told.step = 2.0 * (yb - ya) / (ya + yb);
        told.jump = to.value - from.value;
        told.slope_before = -from.per_deg;
        told.slope_behind = to.per_deg;
        jumps.push_back(std::abs(told.jump));
      }
      for (const Pairs::Bump& bump : pairs.bumps) {
        const double line =
            (1.0 - bump.part) * kLuminance.dot(wall.at(bump.before)) + bump.part * kLuminance.dot(wall.at(bump.behind));
        bumps.push_back(std::abs(kLuminance.dot(wall.at(bump.middle)) / line - 1.0));
      }
    }
    std::vector<double> here;
    for (const auto& [a, b] : seen) here.push_back((lab_of(a, white) - lab_of(b, white)).norm());
    if (content == 0.0) score.delta_e_black_p95 = percentile(here, 0.95);
    all.insert(all.end(), here.begin(), here.end());
  }
  score.step_mean = mean(steps);
  score.step_p95 = percentile(steps, 0.95);
  score.step_max = percentile(steps, 1.0);
  if (!steps.empty()) {
    const auto worst = std::max_element(steps.begin(), steps.end()) - steps.begin();
    score.step_worst_deg = pairs.told[static_cast<std::size_t>(worst)].at_deg;
  }
  score.jump_p95 = percentile(jumps, 0.95);
  score.jump_max = percentile(jumps, 1.0);
  score.borders = std::move(pairs.told);
  score.bump_p95 = percentile(bumps, 0.95);
  score.delta_e_mean = mean(all);
  score.delta_e_p95 = percentile(all, 0.95);
  score.delta_e_max = percentile(all, 1.0);
  return score;
}

RgbImage seen_wall(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry, double content,
                   double white_nits, bool uses_photometry) {
  const ShownWall wall(museum, photometry, content, uses_photometry);
  RgbImage picture(1300, 400);
  for (int y = 0; y < picture.height(); ++y) {
    const double elevation = (20.0 - 0.1 * (y + 0.5)) * kDegree;
    for (int x = 0; x < picture.width(); ++x) {
      const double azimuth = (0.1 * (x + 0.5) - 65.0) * kDegree;
      const Eigen::Vector3d direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                      -std::cos(azimuth) * std::cos(elevation));
      const auto hit = museum.wall().hit({museum.installation().sweet_spot, direction});
      if (!hit) continue;
      const Eigen::Vector3d code = warp::codes_of({}, wall.at(*hit) / white_nits);
      for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(255.0 * code[c]));
    }
  }
  return picture;
}

}  // namespace cyclorama
