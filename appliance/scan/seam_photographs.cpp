// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/seam_photographs.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <optional>

#include "appliance/calibration/measured_blend.h"
#include "appliance/photometry/inverse_map.h"
#include "appliance/scan/head_drawing.h"
#include "appliance/warp/projector_map.h"
#include "common/image/jpeg.h"
#include "common/image/pixel_rect.h"

namespace cyclorama::scan {
namespace {

constexpr int kWidth_px = 640;       // Width of a photograph in the report, which should stay small.
constexpr double kShownWidth = 0.6;  // Fraction of the photograph that is shown, with the seam in its middle.
constexpr float kLit = 0.15f;        // Minimum code of the lit wall, as a fraction of the brightest code.
constexpr int kQuality = 80;
constexpr std::size_t kMinSharedPoints = 6;  // Minimum number of control points in an overlap.
constexpr float kClipped = 0.97f;
constexpr double kMaxClipped = 0.002;
constexpr int kMaxExposures = 6;
constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr std::array kPictures = {TestPicture::kLines, TestPicture::kWhite};

struct Seam {
  std::string first;
  std::string second;
  double heading_rad = 0.0;
};

const calibration::CalibratedProjector* find(const calibration::Calibration& calibration, const std::string& name) {
  const auto at = std::find_if(calibration.projectors.begin(), calibration.projectors.end(),
                               [&](const calibration::CalibratedProjector& p) { return p.name == name; });
  return at == calibration.projectors.end() ? nullptr : &*at;
}

/// Returns the pairs of projectors that overlap, with the middle of each overlap.
std::vector<Seam> seams_of(const calibration::Calibration& calibration) {
  std::vector<Seam> seams;
  for (std::size_t b = 1; b < calibration.projectors.size(); ++b) {
    const auto inverse = photometry::InverseMap::make(calibration.projectors[b].map);
    if (!inverse) continue;
    for (std::size_t a = 0; a < b; ++a) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      std::size_t shared = 0;
      for (const Eigen::Vector3d& d : calibration.projectors[a].map.directions) {
        if (!d.allFinite() || !inverse->pixel_at(d)) continue;
        sum += d;
        ++shared;
      }
      if (shared < kMinSharedPoints) continue;
      seams.push_back({calibration.projectors[a].name, calibration.projectors[b].name, std::atan2(sum.x(), -sum.z())});
    }
  }
  return seams;
}

/// For each test picture, the picture of each head; empty for projectors without a map.
using Drawn = std::array<std::vector<RgbImage>, kPictures.size()>;

Drawn drawn_by(const Installation& installation, const DrawnBy& by) {
  const std::vector<warp::ProjectorMap> planned = warp::projector_maps(installation);
  std::vector<const calibration::MeasuredMap*> maps;
  std::vector<const calibration::CalibratedColour*> colours;
  for (const InstalledProjector& projector : installation.projectors) {
    const calibration::CalibratedProjector* found =
        by.calibration == nullptr ? nullptr : find(*by.calibration, projector.name);
    const bool fits = found != nullptr && found->map.width_px == projector.lens.width_px &&
                      found->map.height_px == projector.lens.height_px;
    maps.push_back(fits ? &found->map : nullptr);
    const auto colour = std::find_if(by.colours.begin(), by.colours.end(),
                                     [&](const calibration::CalibratedColour& c) { return c.name == projector.name; });
    const auto is_of_head = [&](const Image<float, 1>& image) {
      return image.width() == projector.lens.width_px && image.height() == projector.lens.height_px;
    };
    const bool has_colour = fits && colour != by.colours.end() && is_of_head(colour->mask) &&
                            (!colour->colour.black_lift || is_of_head(*colour->colour.black_lift));
    colours.push_back(has_colour ? &*colour : nullptr);
  }
  const bool is_planned = by.calibration == nullptr;
  // Any picture shape that covers all directions works, since the weights are computed in the projectors' pictures.
  const std::vector<warp::MaskImage> masks = is_planned
                                                 ? warp::make_blend_masks(planned)
                                                 : calibration::measured_blend_masks(maps, Equirectangular{4096, 2048});
  Drawn drawn;
  for (std::size_t k = 0; k < kPictures.size(); ++k) {
    std::vector<std::future<RgbImage>> heads;
    for (std::size_t i = 0; i < maps.size(); ++i) {
      DrawnHead head;
      head.width_px = installation.projectors[i].lens.width_px;
      head.height_px = installation.projectors[i].lens.height_px;
      if (is_planned) {
        head.direction_at = [&map = planned[i]](const Eigen::Vector2d& pixel) { return map.view_direction_of(pixel); };
      } else if (maps[i] != nullptr) {
        head.direction_at = [map = maps[i]](const Eigen::Vector2d& pixel) { return map->direction_at(pixel); };
      }
      if (!masks[i].empty()) head.mask = &masks[i];
      if (colours[i] != nullptr) {
        head.mask = &colours[i]->mask;
        head.colour = &colours[i]->colour;
      }
      heads.push_back(std::async(std::launch::async, [head, picture = kPictures.at(k)] {
        return head.direction_at ? drawn_head(head, picture) : RgbImage();
      }));
    }
    for (auto& head : heads) drawn.at(k).push_back(head.get());
  }
  return drawn;
}

/// Returns the part of a photograph around the seam: the middle, over the lit height with a margin.
PixelRect about_the_seam(const ScanPhotograph& white) {
  const int width = static_cast<int>(kShownWidth * white.width());
  const int left = (white.width() - width) / 2;
  float brightest = 0.0f;
  for (const float code : white.data()) brightest = std::max(brightest, code);
  int top = white.height();
  int bottom = 0;
  for (int y = 0; y < white.height(); ++y) {
    int lit = 0;
    for (int x = left; x < left + width; ++x) lit += static_cast<int>(white.at(x, y)[1] > kLit * brightest);
    if (lit * 4 < width) continue;
    top = std::min(top, y);
    bottom = std::max(bottom, y + 1);
  }
  if (bottom <= top) return {left, 0, width, white.height()};
  const int margin = (bottom - top) / 12 + 1;
  top = std::max(0, top - margin);
  bottom = std::min(white.height(), bottom + margin);
  return {left, top, width, bottom - top};
}

/// Downscales by averaging squares of pixels.
RgbImage small(const ScanPhotograph& photograph, const PixelRect& part) {
  const int every = std::max(1, part.width / kWidth_px);
  RgbImage picture(part.width / every, part.height / every);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        float sum = 0.0f;
        for (int v = 0; v < every; ++v) {
          for (int u = 0; u < every; ++u) sum += photograph.at(part.x + x * every + u, part.y + y * every + v)[c];
        }
        const float mean = sum / static_cast<float>(every * every);
        picture.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(mean, 0.0f, 1.0f)));
      }
    }
  }
  return picture;
}

class SeamPhotographing {
 public:
  SeamPhotographing(const Installation& installation, const ScanDevices& devices, const ScanListener& listener,
                    std::stop_token stop)
      : installation_(installation),
        devices_(devices),
        camera_(devices.colour_camera == nullptr ? devices.camera : *devices.colour_camera),
        listener_(listener),
        stop_(std::move(stop)) {}

  Result<SeamPhotographs> run(const DrawnBy& before, const DrawnBy& after, double exposure_s) {
    exposure_s_ = exposure_s;
    const std::array<Drawn, 2> drawn{drawn_by(installation_, before), drawn_by(installation_, after)};
    Result<SeamPhotographs> result = photographed(drawn, {before.when, after.when}, seams_of(*after.calibration));
    // All projectors are made dark, also after an error; the first error is returned.
    const Status dark = show({});
    if (result && !dark) return dark.error();
    return result;
  }

 private:
  Status show(const std::vector<RgbImage>& heads) {
    for (std::size_t i = 0; i < installation_.projectors.size(); ++i)
      TRY(devices_.screen.show(i, i < heads.size() ? heads[i] : RgbImage()));
    return Done{};
  }

  Result<SeamPhotographs> photographed(const std::array<Drawn, 2>& drawn, const std::array<std::string, 2>& when,
                                       const std::vector<Seam>& seams) {
    JpegEncoder encoder;
    const turntable::TurnRange range = devices_.turntable.range();
    for (std::size_t s = 0; s < seams.size(); ++s) {
      const Seam& seam = seams[s];
      if (stop_.stop_requested()) return cancelled();
      TRY(turn_with_retry(devices_.turntable, std::clamp(seam.heading_rad, range.min_rad, range.max_rad)));
      // The exposure is chosen for white, the brightest picture, and serves all photographs, so that they can be
      // compared.
      if (s == 0) TRY(find_exposure(drawn));
      std::vector<ScanPhotograph> taken;
      for (std::size_t k = 0; k < kPictures.size(); ++k) {
        for (std::size_t side = 0; side < 2; ++side) {
          TRY(show(drawn.at(side).at(k)));
          TRY_ASSIGN(ScanPhotograph photograph, take());
          if (listener_) {
            listener_({fmt::format("photographs where '{}' and '{}' meet", seam.first, seam.second),
                       static_cast<double>(s) / static_cast<double>(seams.size()), &photograph});
          }
          taken.push_back(std::move(photograph));
        }
      }
      const PixelRect part = about_the_seam(taken.back());
      for (std::size_t k = 0; k < kPictures.size(); ++k) {
        for (std::size_t side = 0; side < 2; ++side) {
          TRY_ASSIGN(std::vector<std::byte> jpeg,
                     encoder.encode(small(taken[2 * k + side], part), {.quality = kQuality}));
          result_.photographs.push_back({fmt::format("{} and {}, {} {}, {:.0f} degrees", seam.first, seam.second,
                                                     kPictures.at(k) == TestPicture::kLines ? "lines" : "white",
                                                     when.at(side), seam.heading_rad / kDegree),
                                         std::move(jpeg)});
        }
      }
    }
    return std::move(result_);
  }

  Result<ScanPhotograph> take() {
    ++result_.pictures;
    return take_photograph(camera_, exposure_s_, stop_);
  }

  Status find_exposure(const std::array<Drawn, 2>& drawn) {
    for (const Drawn& side : drawn) {
      TRY(show(side.back()));
      for (int round = 0; round < kMaxExposures; ++round) {
        TRY_ASSIGN(const ScanPhotograph photograph, take());
        const auto clipped = std::count_if(photograph.data().begin(), photograph.data().end(),
                                           [](float code) { return code >= kClipped; });
        if (static_cast<double>(clipped) <= kMaxClipped * static_cast<double>(photograph.data().size())) break;
        exposure_s_ *= 0.6;
      }
    }
    return Done{};
  }

  const Installation& installation_;
  const ScanDevices& devices_;
  ScanCamera& camera_;
  const ScanListener& listener_;
  std::stop_token stop_;
  double exposure_s_ = 0.0;
  SeamPhotographs result_;
};

}  // namespace

Result<SeamPhotographs> photograph_seams(const Installation& installation, const DrawnBy& before, const DrawnBy& after,
                                         double exposure_s, const ScanDevices& devices, const ScanListener& listener,
                                         std::stop_token stop) {
  return SeamPhotographing(installation, devices, listener, std::move(stop)).run(before, after, exposure_s);
}

}  // namespace cyclorama::scan
