// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/walk_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

namespace cyclorama::tour {
namespace {

using Eigen::Vector2d;

constexpr std::string_view kTitle = "cyclorama-walk 3";
constexpr std::size_t kMaxNameBytes = 200;
constexpr std::size_t kMaxStops = 1024;
constexpr std::int64_t kMaxTimeNs = 3'200'000'000'000'000'000;
constexpr std::int64_t kMaxDurationNs = 8'640'000'000'000'000;

std::int64_t nanoseconds(Duration d) { return std::chrono::duration_cast<std::chrono::nanoseconds>(d).count(); }

/// Returns the name as one word in which all bytes but letters, digits, '-' and '.' are escaped.
std::string word_of(std::string_view name) {
  std::string word;
  for (const char c : name.substr(0, kMaxNameBytes)) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
    word += plain ? std::string(1, c) : fmt::format("_{:02x}", static_cast<unsigned char>(c));
  }
  return word.empty() ? "_" : word;
}

struct Write {
  TimePoint at;
  const VisitWalk& walk;

  [[nodiscard]] std::string line(std::string_view kind) const { return fmt::format("{} {}", kind, to_nanoseconds(at)); }

  std::string operator()(const SceneOpened& opened) const {
    const Site& site = opened.site;
    std::string text = fmt::format("{} {} {} {} {} {}", line("open"), word_of(opened.name), site.walking_scale,
                                   site.start.position_m.x(), site.start.position_m.y(), site.start.heading_rad);
    const auto polygons = site.area ? site.area->polygons() : std::vector<std::vector<Vector2d>>{};
    fmt::format_to(std::back_inserter(text), " {}", polygons.size());
    for (const std::vector<Vector2d>& polygon : polygons) {
      fmt::format_to(std::back_inserter(text), " {}", polygon.size());
      for (const Vector2d& p : polygon) fmt::format_to(std::back_inserter(text), " {} {}", p.x(), p.y());
    }
    fmt::format_to(std::back_inserter(text), " {}", site.stops.size());
    for (const GuideStop& stop : site.stops)
      fmt::format_to(std::back_inserter(text), " {} {} {} {}", stop.position_m.x(), stop.position_m.y(),
                     stop.heading_rad, nanoseconds(stop.stay));
    fmt::format_to(std::back_inserter(text), " {}", site.ways.size());
    for (const GuideWay& way : site.ways) {
      fmt::format_to(std::back_inserter(text), " {} {} {:d} {}", way.from, way.to, way.is_cut, way.through.size());
      for (const Vector2d& p : way.through) fmt::format_to(std::back_inserter(text), " {} {}", p.x(), p.y());
    }
    return text + fmt::format(" {} {} {:d}", site.pace, site.turn_pace, site.reduced_motion);
  }
  std::string operator()(const PoseSeen& seen) const {
    const std::string head =
        fmt::format("{} {} {} {}", line(seen.body ? "body" : "pose"), seen.tracker, seen.sequence, seen.shutter_ns);
    if (!seen.found) return head + " lost";
    return fmt::format("{} {} {}", head, fmt::join(seen.position_m, " "), fmt::join(seen.rotation, " "));
  }
  std::string operator()(const TrackerLeft& left) const { return fmt::format("{} {}", line("left"), left.tracker); }
  std::string operator()(const KeysPressed& keys) const {
    return fmt::format("{} {} {} {}", line("keys"), keys.command.forward, keys.command.right, keys.command.turn);
  }
  std::string operator()(const LedToStop& led) const { return fmt::format("{} {}", line("led"), led.stop); }
  std::string operator()(const CutToStop& cut) const { return fmt::format("{} {}", line("cut"), cut.stop); }
  std::string operator()(const Held&) const { return line("held"); }
  std::string operator()(const Tick&) const {
    const Walker& walker = walk.navigation.walker;
    return fmt::format("{} {} {} {} {} {} {} {}", line("tick"), walker.position_m.x(), walker.position_m.y(),
                       walker.heading_rad, walker.velocity_m_per_s.x(), walker.velocity_m_per_s.y(),
                       walker.turn_rate_rad_per_s, to_text(walk.navigation.steering_source));
  }
};

/// Reads the words of one line from the left. The first mistake is kept; later reads return zeros.
class Words {
 public:
  explicit Words(std::string_view line) : left_(line) {}

  std::string_view word() {
    if (!mistake_.empty()) return {};
    if (left_.empty()) return fail("ends too early");
    const std::size_t end = std::min(left_.find(' '), left_.size());
    const std::string_view found = left_.substr(0, end);
    left_.remove_prefix(std::min(end + 1, left_.size()));
    return found.empty() ? fail("has an empty word") : found;
  }
  template <typename T>
  T value() {
    const std::string_view text = word();
    T value{};
    if (!mistake_.empty()) return value;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code == std::errc{} && end == text.data() + text.size()) return value;
    fail(fmt::format("has '{}' for a number", text.substr(0, 40)));
    return T{};
  }
  double finite(double min = -1e9, double max = 1e9) {
    const auto number = value<double>();
    if (!mistake_.empty() || (number >= min && number <= max)) return number;
    fail(fmt::format("has {}, which is not between {} and {}", number, min, max));
    return min;
  }
  std::size_t count(std::size_t max) {
    const auto number = value<std::size_t>();
    if (number <= max) return number;
    fail(fmt::format("counts {}; at most {} are possible", number, max));
    return 0;
  }
  /// Times are limited to a hundred years from zero, so that differences never overflow.
  TimePoint time() { return from_nanoseconds(whole(-kMaxTimeNs, kMaxTimeNs)); }
  /// Durations are limited to a hundred days.
  Duration duration() { return std::chrono::nanoseconds(whole(0, kMaxDurationNs)); }
  [[nodiscard]] bool is_next(std::string_view text) const { return mistake_.empty() && left_ == text; }
  std::string_view fail(std::string what) {
    if (mistake_.empty()) mistake_ = std::move(what);
    return {};
  }
  /// Returns an empty string when all words were valid and none is left.
  [[nodiscard]] std::string mistake() {
    if (!left_.empty()) fail("goes on too long");
    return mistake_;
  }

 private:
  std::int64_t whole(std::int64_t min, std::int64_t max) {
    const auto number = value<std::int64_t>();
    if (number >= min && number <= max) return number;
    fail(fmt::format("has the time {}, which is not between {} and {}", number, min, max));
    return 0;
  }
  std::string_view left_;
  std::string mistake_;
};

void read_limits(Words* words, NavigationSettings* ret) {
  WalkLimits& limits = ret->limits;
  limits.forward_m_per_s = words->finite(0.0, 100.0);
  limits.sideways_m_per_s = words->finite(0.0, 100.0);
  limits.turn_rad_per_s = words->finite(0.0, 100.0);
  limits.acceleration_m_per_s2 = words->finite(1e-3, 1e5);
  limits.jerk_m_per_s3 = words->finite(1e-3, 1e5);
  limits.turn_acceleration_rad_per_s2 = words->finite(1e-3, 1e5);
  limits.turn_jerk_rad_per_s3 = words->finite(1e-3, 1e5);
}

GainCurve read_gain(Words* words) {
  GainCurve gain{words->finite(0.0, 100.0), words->finite(0.0, 100.0)};
  if (!(gain.full > gain.dead)) words->fail("has a gain that is not above its dead zone");
  return gain;
}

void read_tag(Words* words, NavigationSettings* ret) {
  TagSteeringSettings& tag = ret->tag;
  tag.neutral_distance_m = words->finite(0.0, 100.0);
  tag.neutral_right_m = words->finite(-100.0, 100.0);
  tag.yaw_rad = read_gain(words);
  tag.sideways_m = read_gain(words);
  tag.distance_m = read_gain(words);
}

void read_body(Words* words, NavigationSettings* ret) {
  BodySteeringSettings& body = ret->body;
  body.mark_distance_m = words->finite(0.0, 100.0);
  body.neutral_right_m = words->finite(-100.0, 100.0);
  body.lean_rad = read_gain(words);
  body.sideways_m = read_gain(words);
  body.distance_m = read_gain(words);
}

void read_times(Words* words, NavigationSettings* ret) {
  ret->tag_smoothing = words->duration();
  ret->guide_after = words->duration();
  ret->max_turn = words->duration();
  ret->turn_pause = words->duration();
}

void read_ways(Words* words, Site* ret_site) {
  const std::size_t ways = words->count(kMaxStops);
  for (std::size_t i = 0; i < ways; ++i) {
    GuideWay way;
    way.from = words->count(kMaxStops);
    way.to = words->count(kMaxStops);
    way.is_cut = words->count(1) == 1;
    const std::size_t positions = words->count(kMaxStops);
    for (std::size_t k = 0; k < positions; ++k) {
      const double x = words->finite();
      way.through.emplace_back(x, words->finite());
    }
    ret_site->ways.push_back(std::move(way));
  }
}

SceneOpened read_open(Words* words) {
  SceneOpened opened{std::string(words->word()), {}};
  Site& site = opened.site;
  site.walking_scale = words->finite(1e-6, 1e6);
  site.start.position_m = {words->finite(), words->finite()};
  site.start.heading_rad = words->finite();
  std::vector<std::vector<Vector2d>> polygons(words->count(WalkableArea::kMaxCorners));
  for (std::vector<Vector2d>& polygon : polygons) {
    const std::size_t corners = words->count(WalkableArea::kMaxCorners);
    for (std::size_t i = 0; i < corners; ++i) {
      const double x = words->finite();
      polygon.emplace_back(x, words->finite());
    }
  }
  if (!polygons.empty()) {
    auto area = WalkableArea::make(polygons.front(), {polygons.begin() + 1, polygons.end()});
    if (area) {
      site.area = std::make_shared<const WalkableArea>(*std::move(area));
    } else {
      words->fail("has no area: " + area.error().message());
    }
  }
  const std::size_t stops = words->count(kMaxStops);
  for (std::size_t i = 0; i < stops; ++i) {
    GuideStop stop;
    stop.position_m.x() = words->finite();
    stop.position_m.y() = words->finite();
    stop.heading_rad = words->finite();
    stop.stay = words->duration();
    site.stops.push_back(std::move(stop));
  }
  read_ways(words, &site);
  site.pace = words->finite(0.0, 1.0);
  site.turn_pace = words->finite(0.0, 1.0);
  site.reduced_motion = words->count(1) == 1;
  if (site.area && !site.area->allows(site.start.position_m)) words->fail("starts outside of its area");
  for (const GuideStop& stop : site.stops)
    if (site.area && !site.area->allows(stop.position_m)) words->fail("has a stop outside of its area");
  return opened;
}

PoseSeen read_pose(Words* words) {
  PoseSeen seen;
  seen.tracker = words->value<std::uint64_t>();
  seen.sequence = words->value<std::uint64_t>();
  seen.shutter_ns = words->value<std::int64_t>();
  seen.found = !words->is_next("lost");
  if (!seen.found) words->word();
  if (seen.found) {
    for (double& value : seen.position_m) value = words->value<double>();
    for (double& value : seen.rotation) value = words->value<double>();
  }
  return seen;
}

RecordedView read_view(Words* words) {
  RecordedView view;
  view.position_m.x() = words->finite();
  view.position_m.y() = words->finite();
  view.heading_rad = words->finite();
  view.velocity_m_per_s.x() = words->finite();
  view.velocity_m_per_s.y() = words->finite();
  view.turn_rate_rad_per_s = words->finite();
  const std::string_view name = words->word();
  for (const SteeringSource steering_source :
       {SteeringSource::kNobody, SteeringSource::kKeys, SteeringSource::kTag, SteeringSource::kGuide}) {
    if (name != to_text(steering_source)) continue;
    view.steering_source = steering_source;
    return view;
  }
  words->fail("names nobody who steers");
  return view;
}

WalkEntry read_entry(Words* words) {
  WalkEntry entry;
  const std::string_view kind = words->word();
  entry.at = words->time();
  if (kind == "tick") {
    entry.event = Tick{};
    entry.view = read_view(words);
  } else if (kind == "pose" || kind == "body") {
    PoseSeen seen = read_pose(words);
    seen.body = kind == "body";
    entry.event = seen;
  } else if (kind == "keys") {
    const auto forward = words->value<double>();
    const auto right = words->value<double>();
    entry.event = KeysPressed{{forward, right, words->value<double>()}};
  } else if (kind == "left") {
    entry.event = TrackerLeft{words->value<std::uint64_t>()};
  } else if (kind == "led") {
    entry.event = LedToStop{words->count(kMaxStops)};
  } else if (kind == "cut") {
    entry.event = CutToStop{words->count(kMaxStops)};
  } else if (kind == "held") {
    entry.event = Held{};
  } else if (kind == "open") {
    entry.event = read_open(words);
  } else {
    words->fail("begins with none of open, pose, body, left, keys, led, cut, held, tick");
  }
  return entry;
}

bool is_same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

std::string describe(const RecordedView& view) {
  return fmt::format("({}, {}) heading {} at {} {} {} by {}", view.position_m.x(), view.position_m.y(),
                     view.heading_rad, view.velocity_m_per_s.x(), view.velocity_m_per_s.y(), view.turn_rate_rad_per_s,
                     to_text(view.steering_source));
}

}  // namespace

RecordedView RecordedView::of(const Navigation& navigation) {
  const Walker& walker = navigation.walker;
  return {walker.position_m, walker.heading_rad, walker.velocity_m_per_s, walker.turn_rate_rad_per_s,
          navigation.steering_source};
}

bool RecordedView::is_same(const RecordedView& other) const {
  return is_same_bits(position_m.x(), other.position_m.x()) && is_same_bits(position_m.y(), other.position_m.y()) &&
         is_same_bits(heading_rad, other.heading_rad) &&
         is_same_bits(velocity_m_per_s.x(), other.velocity_m_per_s.x()) &&
         is_same_bits(velocity_m_per_s.y(), other.velocity_m_per_s.y()) &&
         is_same_bits(turn_rate_rad_per_s, other.turn_rate_rad_per_s) && steering_source == other.steering_source;
}

std::string record_head(const NavigationSettings& settings) {
  const WalkLimits& limits = settings.limits;
  const TagSteeringSettings& tag = settings.tag;
  std::string text =
      fmt::format("{}\nlimits {} {} {} {} {} {} {}\n", kTitle, limits.forward_m_per_s, limits.sideways_m_per_s,
                  limits.turn_rad_per_s, limits.acceleration_m_per_s2, limits.jerk_m_per_s3,
                  limits.turn_acceleration_rad_per_s2, limits.turn_jerk_rad_per_s3);
  fmt::format_to(std::back_inserter(text), "tag {} {}", tag.neutral_distance_m, tag.neutral_right_m);
  for (const GainCurve& gain : {tag.yaw_rad, tag.sideways_m, tag.distance_m})
    fmt::format_to(std::back_inserter(text), " {} {}", gain.dead, gain.full);
  const BodySteeringSettings& body = settings.body;
  fmt::format_to(std::back_inserter(text), "\nbody {} {}", body.mark_distance_m, body.neutral_right_m);
  for (const GainCurve& gain : {body.lean_rad, body.sideways_m, body.distance_m})
    fmt::format_to(std::back_inserter(text), " {} {}", gain.dead, gain.full);
  fmt::format_to(std::back_inserter(text), "\ntimes {} {} {} {}\n", nanoseconds(settings.tag_smoothing),
                 nanoseconds(settings.guide_after), nanoseconds(settings.max_turn), nanoseconds(settings.turn_pause));
  return text;
}

std::string record_line(const WalkEvent& event, TimePoint at, const VisitWalk& walk) {
  return std::visit(Write{at, walk}, event) + "\n";
}

Result<WalkRecord> parse_walk_record(std::string_view text, const std::string& name) {
  WalkRecord record;
  std::size_t line_number = 0;
  while (true) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) break;
    ++line_number;
    Words words(text.substr(0, end));
    if (line_number == 1) {
      if (!words.is_next(kTitle)) words.fail(fmt::format("is not '{}'; was it written by --record?", kTitle));
      words = words.is_next(kTitle) ? Words("") : words;
    } else if (line_number <= 5) {
      constexpr std::string_view kHead[] = {"limits", "tag", "body", "times"};
      constexpr void (*kRead[])(Words*, NavigationSettings*) = {read_limits, read_tag, read_body, read_times};
      const std::string_view expected = kHead[line_number - 2];
      if (words.word() != expected) words.fail(fmt::format("does not begin with '{}'", expected));
      kRead[line_number - 2](&words, &record.settings);
    } else {
      record.entries.push_back(read_entry(&words));
      record.entries.back().line = line_number;
    }
    if (const std::string mistake = words.mistake(); !mistake.empty())
      return Error(ErrorCode::kBadData, fmt::format("{}:{}: the line {}", name, line_number, mistake));
    text.remove_prefix(end + 1);
  }
  if (line_number < 5)
    return Error(ErrorCode::kBadData, fmt::format("{}:{}: ends before its settings; it is no walk", name, line_number));
  return record;
}

WalkReplay replayed(const WalkRecord& record) {
  WalkReplay replay;
  VisitWalk walk;
  ViewMeter meter(1.0);
  std::optional<std::pair<TimePoint, TimePoint>> span;
  for (const WalkEntry& entry : record.entries) {
    walk = after(std::move(walk), entry.event, entry.at, record.settings);
    span = std::pair(std::min(span ? span->first : entry.at, entry.at),
                     std::max(span ? span->second : entry.at, entry.at));
    if (std::holds_alternative<PoseSeen>(entry.event)) ++replay.poses;
    if (!entry.view) {
      const bool is_elsewhere =
          std::holds_alternative<SceneOpened>(entry.event) || std::holds_alternative<CutToStop>(entry.event);
      if (is_elsewhere) meter.restart(walk.site.walking_scale);
      continue;
    }
    ++replay.ticks;
    const RecordedView view = RecordedView::of(walk.navigation);
    meter.add(view.position_m, view.heading_rad, entry.at);
    if (replay.difference || view.is_same(*entry.view)) continue;
    replay.difference = fmt::format("line {}: {} was recorded, but the replay gives {}", entry.line,
                                    describe(*entry.view), describe(view));
  }
  replay.peaks = meter.peaks();
  if (span) replay.length = span->second - span->first;
  return replay;
}

}  // namespace cyclorama::tour
