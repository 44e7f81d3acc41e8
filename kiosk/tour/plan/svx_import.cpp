// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/svx_import.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "common/base/text.h"
#include "common/geometry/panorama.h"
#include "common/json/strict_json.h"

namespace cyclorama::tour {
namespace {

constexpr std::size_t kMaxParts = 10'000;  // Limit of any list in a document.
constexpr double kLevelDeg = 5.0;          // Pitch or roll that needs no remark.
constexpr std::size_t kMaxRemarks = 500;

struct Camera {
  std::array<double, 3> orbit_deg{};  ///< Pitch, yaw, roll.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

/// Lengths of the document's units in metres; the schema has no others.
std::optional<double> metres_of(const std::string& unit) {
  static const std::map<std::string, double> kUnits{{"mm", 1e-3},   {"cm", 1e-2},   {"m", 1.0},     {"km", 1e3},
                                                    {"in", 0.0254}, {"ft", 0.3048}, {"yd", 0.9144}, {"mi", 1609.344}};
  const auto found = kUnits.find(unit);
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

class SvxReader {
 public:
  SvxReader(const nlohmann::json& document, StrictJson::Mistakes* mistakes) : root_(document, mistakes) {}

  Result<SvxImport> read(const std::string& name, std::size_t tour) {
    import_.plan.languages = {"en"};
    read_units();
    find_setup();
    if (tours_.size() <= tour) {
      return Error(ErrorCode::kNotFound, fmt::format("{}: has {} tours, so none is number {}; choose another, or make "
                                                     "the tour in Voyager Story first",
                                                     name, tours_.size(), tour + 1));
    }
    for (std::size_t i = 0; i < tours_.size(); ++i) {
      if (i != tour)
        leave_out(fmt::format("tour {} ('{}'): import it into a folder of its own", i + 1, title_of(tours_[i])));
    }
    read_tour(tours_[tour]);
    read_annotations();
    if (import_.plan.stops.empty())
      return Error(ErrorCode::kNotFound, fmt::format("{}: no step of the tour has a snapshot with a camera", name));
    add_first_language();
    return std::move(import_);
  }

 private:
  void leave_out(std::string what) {
    if (import_.left_out.size() < kMaxRemarks) import_.left_out.push_back(std::move(what));
  }

  void read_units() {
    if (!root_.has("scenes")) return;
    std::vector<StrictJson> scenes = root_.list("scenes", 0, kMaxParts);
    if (scenes.empty() || !scenes.front().has("units")) return;
    const auto metres = metres_of(scenes.front().text("units"));
    if (!metres) return scenes.front().at("units").refuse("is no unit of Voyager's; use \"m\"");
    unit_m_ = *metres;
  }

  /// Collects the tours and the snapshots' cameras of all setups.
  void find_setup() {
    if (!root_.has("setups")) return;
    for (StrictJson& setup : root_.list("setups", 0, kMaxParts)) {
      if (setup.has("tours"))
        for (StrictJson& tour : setup.list("tours", 0, kMaxParts)) tours_.push_back(tour);
      if (setup.has("snapshots")) read_snapshots(setup.at("snapshots"));
      for (const char* const key : {"audio", "tape", "slicer"})
        if (setup.has(key)) leave_out(fmt::format("the setup's '{}'", key));
    }
  }

  void read_snapshots(StrictJson snapshots) {
    // Each state has a value for each target; a target is the path of a property.
    std::optional<std::size_t> orbit;
    std::optional<std::size_t> offset;
    const std::vector<StrictJson> targets = snapshots.list("targets", 0, kMaxParts);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const std::string path = targets[i].as_text();
      if (path.ends_with("/orbit"))
        orbit = i;
      else if (path.ends_with("/offset"))
        offset = i;
      else if (path.find("navigation") == std::string::npos)
        leave_out(fmt::format("what the snapshots set at '{}'", printable(path)));
    }
    for (StrictJson& state : snapshots.list("states", 0, kMaxParts)) {
      const std::string id = state.text("id");
      const std::vector<StrictJson> values = state.list("values", 0, kMaxParts);
      if (!orbit || !offset || *orbit >= values.size() || *offset >= values.size()) continue;
      Camera camera;
      const std::vector<StrictJson> angles = values[*orbit].elements(3, 3);
      const std::vector<StrictJson> lengths = values[*offset].elements(3, 3);
      for (std::size_t k = 0; k < std::min(angles.size(), lengths.size()); ++k) {
        camera.orbit_deg[k] = angles[k].as_number(-1e6, 1e6);
        camera.offset[static_cast<Eigen::Index>(k)] = lengths[k].as_number(-1e9, 1e9);
      }
      cameras_[id] = camera;
    }
  }

  /// Reads a text and its translations: "title" and "titles", "lead" and "leads".
  Texts texts_of(StrictJson& from, const char* key, const char* plural, std::size_t max_bytes) {
    Texts texts;
    const auto add = [&](const std::string& language, const std::string& words) {
      std::string text = words;
      std::ranges::replace_if(
          text, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
      if (text.empty()) return;
      if (text.size() > max_bytes) leave_out(fmt::format("the end of the text '{}'", printable(text)));
      text = printable(text, max_bytes - 3);  // Room for the ellipsis.
      if (std::ranges::find(import_.plan.languages, language) == import_.plan.languages.end())
        import_.plan.languages.push_back(language);
      texts[language] = text;
    };
    if (from.has(key)) add("en", from.text(key, kMaxParts));
    if (!from.has(plural)) return texts;
    StrictJson translations = from.at(plural);
    for (const char* const language : {"EN", "ES", "DE", "NL", "JA", "FR", "IT", "HAW"})
      if (translations.has(language)) add(lower_case(language), translations.text(language, kMaxParts));
    return texts;
  }

  std::string title_of(StrictJson tour) {
    return tour.has("title") ? printable(tour.text("title", kMaxParts)) : "untitled";
  }

  void read_tour(StrictJson tour) {
    import_.plan.title = texts_of(tour, "title", "titles", kMaxTitleBytes);
    for (const char* const key : {"lead", "leads", "tags", "taglist"})
      if (tour.has(key)) leave_out(fmt::format("the tour's '{}'", key));
    if (!tour.has("steps")) return;
    for (StrictJson& step : tour.list("steps", 0, kMaxParts)) add_stop(step, "id", "step");
  }

  void read_annotations() {
    if (!root_.has("models")) return;
    for (StrictJson& model : root_.list("models", 0, kMaxParts)) {
      if (!model.has("annotations")) continue;
      for (StrictJson& annotation : model.list("annotations", 0, kMaxParts)) {
        if (annotation.has("viewId"))
          add_stop(annotation, "viewId", "annotation");
        else
          leave_out(fmt::format("the annotation '{}', which has no view", title_of(annotation)));
        for (const char* const key : {"articleId", "imageUri", "zoneIndex", "audioId"})
          if (annotation.has(key)) leave_out(fmt::format("'{}' of the annotation '{}'", key, title_of(annotation)));
      }
    }
  }

  void add_stop(StrictJson& from, const char* id_key, const char* kind) {
    const std::string title = title_of(from);
    const auto camera = cameras_.find(from.has(id_key) ? from.text(id_key) : "");
    if (camera == cameras_.end())
      return leave_out(fmt::format("the {} '{}', which has no snapshot of a camera", kind, title));
    if (import_.plan.stops.size() >= kMaxPlannedStops)
      return leave_out(fmt::format("the {} '{}'; a tour has at most {} stops", kind, title, kMaxPlannedStops));
    const auto& [pitch, yaw, roll] = camera->second.orbit_deg;
    const Eigen::Vector3d eye =
        unit_m_ * (Eigen::AngleAxisd(yaw * kRadiansPerDegree, Eigen::Vector3d::UnitY()) *
                   (Eigen::AngleAxisd(pitch * kRadiansPerDegree, Eigen::Vector3d::UnitX()) * camera->second.offset));
    constexpr double kMaxM = 1e6;
    if (!(eye.cwiseAbs().maxCoeff() <= kMaxM))
      return leave_out(fmt::format("the {} '{}', which is too far away", kind, title));
    PlannedStop planned;
    planned.stop.name = fmt::format("stop-{}", import_.plan.stops.size() + 1);
    planned.stop.position_m = {eye.x(), eye.z()};
    planned.stop.heading_rad = wrapped_angle(-yaw * kRadiansPerDegree);
    planned.title = texts_of(from, "title", "titles", kMaxTitleBytes);
    planned.text = texts_of(from, "lead", "leads", kMaxTextBytes);
    if (std::abs(pitch) > kLevelDeg || std::abs(roll) > kLevelDeg)
      leave_out(fmt::format("the pitch of {:.0f} and the roll of {:.0f} degrees at '{}'", pitch, roll, title));
    import_.plan.stops.push_back(std::move(planned));
  }

  /// A tour shows its first language wherever another is missing, so that one must be there.
  void add_first_language() {
    const std::string& first = import_.plan.languages.front();
    const auto complete = [&](Texts* texts) {
      if (!texts->empty() && !texts->contains(first)) (*texts)[first] = texts->begin()->second;
    };
    complete(&import_.plan.title);
    for (PlannedStop& planned : import_.plan.stops) {
      complete(&planned.title);
      complete(&planned.text);
      planned.stop.title = planned.title.empty() ? planned.stop.name : planned.title[first];
    }
  }

  StrictJson root_;
  double unit_m_ = 1.0;
  std::vector<StrictJson> tours_;
  std::map<std::string, Camera> cameras_;
  SvxImport import_;
};

}  // namespace

Result<SvxImport> import_svx(std::string_view text, const std::string& name, std::size_t tour) {
  constexpr const char* kRemedy = "export the document from Voyager Story again";
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, kRemedy));
  StrictJson::Mistakes mistakes(kRemedy);
  SvxReader reader(document, &mistakes);
  auto import = reader.read(name, tour);
  TRY(mistakes.status(name));
  return import;
}

}  // namespace cyclorama::tour
