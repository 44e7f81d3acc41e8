// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "appliance/calibration/calibration_file.h"
#include "appliance/scan/wall_plot.h"
#include "common/base/file.h"

namespace cyclorama::scan {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Calibration</title>
<style>
body { font: 15px/1.45 system-ui, sans-serif; max-width: 1040px; margin: 2em auto; padding: 0 1em; color: #222; background: #fff; }
h1 { font-size: 1.6em; } h2 { font-size: 1.15em; margin-top: 2em; }
table { border-collapse: collapse; } td, th { padding: .25em .8em; border-bottom: 1px solid #ddd; text-align: right; }
td:first-child, th:first-child { text-align: left; } tr.chosen { background: #e8f5e9; font-weight: 600; }
svg { width: 100%; height: auto; background: #fafafa; } svg text { font: 12px system-ui, sans-serif; fill: #777; }
svg text.name { font-size: 16px; font-weight: 600; fill: #222; } .grid { stroke: #ddd; fill: none; }
.key span { display: inline-block; margin-right: 1.2em; } .key i { display: inline-block; width: 1em; height: 1em; vertical-align: -.15em; margin-right: .35em; }
.pairs { display: grid; grid-template-columns: 1fr 1fr; gap: .5em; } figure { margin: .5em 0; } img { max-width: 100%; }
figcaption { font-size: .85em; color: #555; } .remarks { background: #fff8e1; padding: .6em 1em .6em 2em; }
</style></head><body>
)";

std::string base64(std::span<const std::byte> bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? static_cast<std::uint32_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[word >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::string key() {
  std::string text = "<p class=\"key\">";
  for (const PlotStep& step : pixel_scale_steps())
    text += fmt::format("<span><i style=\"background:{}\"></i>{}</span>", step.colour, step.text);
  return text + "</p>\n";
}

double covered(const calibration::MeasuredMap& map) {
  const auto known = std::ranges::count_if(map.directions, [](const auto& d) { return d.allFinite(); });
  return map.directions.empty() ? 0.0 : static_cast<double>(known) / static_cast<double>(map.directions.size());
}

double median_sigma_px(const calibration::MeasuredMap& map) {
  std::vector<double> sigmas;
  for (const double sigma : map.sigma_px) {
    if (std::isfinite(sigma)) sigmas.push_back(sigma);
  }
  if (sigmas.empty()) return 0.0;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle;
}

std::string projectors_table(const calibration::Calibration& calibration) {
  std::string text =
      "<h2>Projectors</h2>\n<table><tr><th>projector</th><th>pixels</th><th>covered</th><th>samples</th>"
      "<th>held-out error</th><th>median uncertainty</th><th></th></tr>\n";
  for (const calibration::CalibratedProjector& p : calibration.projectors) {
    text += fmt::format(
        "<tr><td>{}</td><td>{} \u00d7 {}</td><td>{:.1f} %</td><td>{}</td><td>{:.3f} px</td><td>{:.3f} px</td>"
        "<td>{}</td></tr>\n",
        html_text(p.name), p.map.width_px, p.map.height_px, 100.0 * covered(p.map), p.map.samples, p.map.heldout_rms_px,
        median_sigma_px(p.map), p.is_previous ? "the previous map: it predicted better" : "");
  }
  return text + "</table>\n";
}

std::string turntable_table(const calibration::CalibratedTurntable& turntable) {
  std::string text = fmt::format(
      "<h2>Camera and turntable</h2>\n<p>{} directions, {} points seen from several of them; {:.3f} px of what was "
      "used, {:.3f} px of what was left out. The measurements alone determine {} of {} parameters. Offset from the "
      "axis: {}.</p>\n",
      turntable.angles_rad.size(), turntable.tracks, turntable.rms_px, turntable.heldout_rms_px, turntable.rank,
      turntable.parameters.size(), html_text(turntable.offset_reason));
  const auto rows = static_cast<std::size_t>(turntable.covariance.rows());
  if (turntable.parameters.empty() || rows != turntable.parameters.size()) return text;
  text += "<table><tr><th>parameter</th><th>standard deviation</th></tr>\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    text += fmt::format("<tr><td>{}</td><td>{:.2g}</td></tr>\n", html_text(turntable.parameters[i]),
                        std::sqrt(std::max(0.0, turntable.covariance(at, at))));
  }
  return text + "</table>\n";
}

std::string trials_table(const std::vector<calibration::ModelTrial>& trials, std::string_view chosen) {
  std::string text =
      "<table><tr><th>model</th><th>parameters</th><th>error, trained</th><th>error, held "
      "out</th><th>scatter</th></tr>\n";
  for (const calibration::ModelTrial& t : trials) {
    text += fmt::format("<tr{}><td>{}</td><td>{}</td><td>{:.3f} px</td><td>{:.3f} px</td><td>{:.2g}{}</td></tr>\n",
                        t.name == chosen ? " class=\"chosen\"" : "", html_text(t.name), t.parameters, t.training_rms_px,
                        t.heldout_rms_px, t.scatter, t.is_usable ? "" : " (not usable)");
  }
  return text + "</table>\n";
}

std::string plots(const calibration::Calibration& calibration, const ReportFindings& findings) {
  std::vector<const calibration::MeasuredMap*> maps;
  for (const calibration::CalibratedProjector& p : calibration.projectors) maps.push_back(&p.map);
  WallPlot areas(maps);
  for (std::size_t i = 0; i < maps.size(); ++i)
    areas.add_area(*maps[i], projector_colour(i), calibration.projectors[i].name);
  std::string text = "<h2>Coverage</h2>\n<p>The wall from the sweet spot: azimuth and elevation in degrees.</p>\n" +
                     areas.svg("Coverage");
  if (!findings.residuals.empty()) {
    WallPlot residuals(maps);
    std::vector<WallPlot::Spot> spots;
    for (const WallResidual& r : findings.residuals) spots.push_back({r.direction, r.error_px});
    residuals.add_spots(spots);
    text +=
        "<h2>Residuals over the wall</h2>\n<p>How far each place that the camera saw lies from where the maps draw "
        "it, in projector pixels; the noise of single places is in it.</p>\n" +
        residuals.svg("Residuals") + key();
  }
  text +=
      "<h2>Uncertainty</h2>\n<p>Of each projector's map: standard deviations in its pixels. Gaps that were bridged "
      "stand out.</p>\n";
  for (std::size_t i = 0; i < maps.size(); ++i) {
    WallPlot sigmas(maps);
    sigmas.add_sigmas(*maps[i]);
    text += fmt::format("<h3>{}</h3>\n", html_text(calibration.projectors[i].name)) +
            sigmas.svg("Uncertainty of " + calibration.projectors[i].name);
  }
  return text + key();
}

}  // namespace

std::string report_page(const calibration::Calibration& calibration, const ReportFindings& findings) {
  std::string page = kHead + fmt::format("<h1>Calibration of {}</h1>\n", html_text(calibration.date));
  if (findings.registration && findings.registration->correspondences > 0) {
    page += fmt::format(
        "<p>Where two projectors meet they agree within {:.2f} px in the mean, {:.2f} px on 95 % of {} "
        "places.</p>\n",
        findings.registration->mean_px, findings.registration->p95_px, findings.registration->correspondences);
  }
  if (!calibration.remarks.empty()) {
    page += "<h2>What is not as it could be</h2>\n<ul class=\"remarks\">\n";
    for (const std::string& remark : calibration.remarks) page += fmt::format("<li>{}</li>\n", html_text(remark));
    page += "</ul>\n";
  }
  page += projectors_table(calibration);
  page += plots(calibration, findings);
  if (!findings.photographs.empty()) {
    page +=
        "<h2>Seams</h2>\n<p>Photographs of the wall where two projectors meet, before and after: lines every two "
        "degrees as the sweet spot sees them, which should go on through the seam, and white, which should be even. "
        "The camera's own distortion and vignetting are in them.</p>\n<div class=\"pairs\">\n";
  }
  for (const ReportFindings::Photograph& photograph : findings.photographs) {
    page += fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/jpeg;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
        html_text(photograph.caption), base64(photograph.jpeg));
  }
  if (!findings.photographs.empty()) page += "</div>\n";
  page += turntable_table(calibration.turntable);
  if (calibration.wall) {
    const calibration::ModelChoice& wall = *calibration.wall;
    page += fmt::format("<h2>The wall</h2>\n<p>{}, and lenses of {}: {}.</p>\n",
                        calibration::name_of(wall.fit.surface.model), calibration::name_of(wall.lens),
                        html_text(wall.reason));
    page += trials_table(wall.surfaces, calibration::name_of(wall.fit.surface.model));
    page += "<p></p>\n" + trials_table(wall.lenses, calibration::name_of(wall.lens));
  }
  return page + "</body></html>\n";
}

std::vector<WallResidual> wall_residuals(const solve::Measurements& measurements,
                                         const calibration::Calibration& calibration, std::size_t max) {
  std::size_t all = 0;
  for (const solve::TurntableDirection& direction : measurements.directions) all += direction.correspondences.size();
  const std::size_t every = std::max<std::size_t>(1, all / std::max<std::size_t>(1, max));
  std::vector<WallResidual> residuals;
  std::size_t n = 0;
  for (std::size_t d = 0; d < measurements.directions.size(); ++d) {
    for (const solve::Correspondence& c : measurements.directions[d].correspondences) {
      if (n++ % every != 0 || c.projector >= calibration.projectors.size()) continue;
      const auto seen = solve::seen_direction(calibration.turntable, d,
                                              {static_cast<double>(c.camera_u), static_cast<double>(c.camera_v)});
      const calibration::MeasuredMap& map = calibration.projectors[c.projector].map;
      const Eigen::Vector2d pixel(static_cast<double>(c.projector_x), static_cast<double>(c.projector_y));
      const auto drawn = map.direction_at(pixel);
      // Direction of the neighbouring pixel, which gives the angle per pixel.
      const auto beside = map.direction_at(pixel + Eigen::Vector2d(pixel.x() > 1.0 ? -1.0 : 1.0, 0.0));
      if (!seen || !drawn || !beside) continue;
      const double step = (*beside - *drawn).norm();
      if (!(step > 0.0)) continue;
      residuals.push_back({c.projector, *seen, (*seen - *drawn).norm() / step});
    }
  }
  return residuals;
}

Result<std::filesystem::path> write_report(const std::filesystem::path& folder,
                                           const calibration::Calibration& calibration,
                                           const ReportFindings& findings) {
  const std::filesystem::path file = calibration::calibration_folder(folder, calibration.date) / "report.html";
  TRY(write_file_atomically(file, report_page(calibration, findings)));
  return file;
}

}  // namespace cyclorama::scan
