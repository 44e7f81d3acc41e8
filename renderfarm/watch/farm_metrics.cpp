// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/farm_metrics.h"

#include <fmt/format.h>
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <set>

namespace cyclorama::watch {
namespace {

using prometheus::ClientMetric;
using prometheus::Counter;
using prometheus::Family;
using prometheus::Histogram;
using prometheus::MetricFamily;

constexpr const char* kOthers = "(others)";

const char* word_for(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return "invalid";
    case ErrorCode::kNotFound:
      return "not_found";
    case ErrorCode::kBusy:
      return "full";
    case ErrorCode::kUnavailable:
      return "unavailable";
    case ErrorCode::kTimedOut:
      return "silent";
    case ErrorCode::kBadData:
      return "bad_data";
    case ErrorCode::kSystem:
      break;
  }
  return "system";
}

/// Bounds in seconds, from a tenth of the smallest relevant duration to far beyond any budget.
const Histogram::BucketBoundaries kSeconds{0.0001, 0.00025, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02,
                                           0.05,   0.1,     0.2,    0.5,   1.0,   2.0,   5.0};

Family<Counter>& counter(prometheus::Registry& registry, const char* name, const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

/// Gauges that are rebuilt for each response, so that no outdated series remains.
class Gauges {
 public:
  void add(const char* name, const char* help) { families_.push_back({name, help, prometheus::MetricType::Gauge, {}}); }
  /// Adds a sample to the most recently added family.
  void sample(std::vector<ClientMetric::Label> labels, double value) {
    ClientMetric metric;
    metric.label = std::move(labels);
    metric.gauge.value = value;
    families_.back().metric.push_back(std::move(metric));
  }
  [[nodiscard]] std::vector<MetricFamily> take() && { return std::move(families_); }

 private:
  std::vector<MetricFamily> families_;
};

void add_nodes(const std::vector<WatchedNode>& nodes, Gauges* gauges) {
  std::map<std::string, int> seen;
  std::vector<std::string> names;
  for (const WatchedNode& node : nodes) {
    const int count = ++seen[node.name];
    names.push_back(count == 1 ? node.name : fmt::format("{} #{}", node.name, count));
  }
  const auto each = [&](const char* name, const char* help, const std::function<double(const WatchedNode&)>& value) {
    gauges->add(name, help);
    for (std::size_t i = 0; i < nodes.size(); ++i) gauges->sample({{"node", names[i]}}, value(nodes[i]));
  };
  const auto is = [](const char* state) {
    return [state](const WatchedNode& node) { return node.state == state ? 1.0 : 0.0; };
  };
  each("cyclorama_node_threads", "Threads that render", [](const auto& n) { return n.threads; });
  each("cyclorama_node_speed_ratio", "Speed of one thread, relative to the first measured node",
       [](const auto& n) { return n.speed; });
  each("cyclorama_node_blocks", "Blocks ordered and not yet finished",
       [](const auto& n) { return static_cast<double>(n.blocks); });
  each("cyclorama_node_blocks_waiting", "Blocks that the node has not started",
       [](const auto& n) { return static_cast<double>(n.blocks_waiting); });
  each("cyclorama_node_memory_bytes", "Resident set of the node's process",
       [](const auto& n) { return static_cast<double>(n.memory_bytes); });
  each("cyclorama_node_uptime_seconds", "Time since the node's process started",
       [](const auto& n) { return n.uptime_s; });
  each("cyclorama_node_load_ratio",
       "Load over the largest load in a frame, smoothed; 1 for all nodes is a perfect balance",
       [](const auto& n) { return n.load_share; });
  each("cyclorama_node_scenes", "Scenes loaded", [](const auto& n) { return static_cast<double>(n.scenes.size()); });
  each("cyclorama_node_ready", "1 if it has a scene and receives blocks", is("ready"));
  each("cyclorama_node_late", "1 while it delays frames and receives no blocks", is("late"));
  each("cyclorama_node_draining", "1 while it is about to stop", is("stops"));
}

}  // namespace

struct FarmMetrics::Series {
  prometheus::Registry registry;
  Family<Counter>& frames = counter(registry, "cyclorama_frames_total", "Whole frames of moving pictures");
  Family<Counter>& refined = counter(registry, "cyclorama_frames_refined_total", "Refined pictures at rest");
  Family<Counter>& late = counter(registry, "cyclorama_frames_late_total", "Frames given up at their deadline");
  Family<Counter>& given_up =
      counter(registry, "cyclorama_frames_given_up_total", "Frames given up for other reasons than the deadline");
  Family<Counter>& bytes = counter(registry, "cyclorama_frame_bytes_total", "Bytes of all frames: JPEG and depth");
  Family<Counter>& sessions = counter(registry, "cyclorama_sessions_opened_total", "Sessions that were opened");
  Family<Counter>& refusals =
      counter(registry, "cyclorama_sessions_refused_total", "Sessions refused or ended by the farm, and why");
  Counter& rays = counter(registry, "cyclorama_rays_total", "Rays traced for frames").Add({});
  Counter& reassigned = counter(registry, "cyclorama_frames_given_again_total",
                                "Frames for which other nodes rendered what one failed to deliver")
                            .Add({});
  Counter& moved =
      counter(registry, "cyclorama_blocks_moved_total", "Blocks that an idle node took from another").Add({});
  Counter& sent_away =
      counter(registry, "cyclorama_nodes_sent_away_total", "Nodes whose stream the coordinator ended").Add({});
  Counter& scene_bytes =
      counter(registry, "cyclorama_scene_bytes_sent_total", "Bytes of scene files sent to nodes").Add({});
  Family<Histogram>& stages = prometheus::BuildHistogram()
                                  .Name("cyclorama_frame_seconds")
                                  .Help("One step of a frame's way through the farm")
                                  .Register(registry);

  mutable std::mutex mutex;  ///< Guards the following.
  std::set<std::string> museums;
  FarmOverview overview;

  /// Returns the label for a museum. The number of label values is bounded, because museums choose their names and high
  /// cardinality overloads a metrics server.
  std::string label_of(const std::string& museum) {
    const std::lock_guard lock(mutex);
    return label_while_locked(museum);
  }
  std::string label_while_locked(const std::string& museum) {
    const std::string name = museum.empty() ? "(unnamed)" : museum;
    if (museums.contains(name)) return name;
    if (museums.size() >= kMaxMuseums) return kOthers;
    return *museums.insert(name).first;
  }

  void add_sessions(Gauges* gauges) {
    std::map<std::string, std::vector<const WatchedSession*>> by_museum;
    for (const WatchedSession& session : overview.sessions)
      by_museum[label_while_locked(session.museum)].push_back(&session);
    gauges->add("cyclorama_sessions", "Sessions that are open");
    for (const auto& [museum, sessions_of] : by_museum) {
      gauges->sample({{"museum", museum}}, static_cast<double>(sessions_of.size()));
    }
    // If a museum has several sessions, shows the worst value, which alerts should see.
    const auto worst = [&](const char* name, const char* help, bool min,
                           const std::function<double(const WatchedSession&)>& value) {
      gauges->add(name, help);
      for (const auto& [museum, sessions_of] : by_museum) {
        std::vector<double> values;
        for (const WatchedSession* const session : sessions_of) values.push_back(value(*session));
        gauges->sample({{"museum", museum}}, min ? std::ranges::min(values) : std::ranges::max(values));
      }
    };
    worst("cyclorama_session_samples_per_pixel", "Samples per pixel of the last frame, in total", true,
          [](const auto& v) { return v.samples_per_pixel; });
    worst("cyclorama_session_scale_ratio", "Rendered width over requested width of the last frame", true,
          [](const auto& v) { return v.scale; });
    worst("cyclorama_session_budget_seconds",
          "Time per frame that the session requested; 0: its views state their quality", true,
          [](const auto& v) { return 1e-3 * v.budget_ms; });
    worst("cyclorama_session_frame_seconds", "Duration of the last frame, from the view's arrival to the frame's end",
          false, [](const auto& v) { return 1e-3 * v.frame_ms; });
    worst("cyclorama_session_frame_bytes", "Bytes of the last frame: JPEG and depth", false,
          [](const auto& v) { return v.bytes_per_frame; });
    worst("cyclorama_session_balance_efficiency_ratio", "Mean load over largest load of the nodes in the last frame",
          true, [](const auto& v) { return v.balance_efficiency; });
  }
};

FarmMetrics::FarmMetrics() : series_(std::make_unique<Series>()) {}
FarmMetrics::~FarmMetrics() = default;

void FarmMetrics::add(const FrameFigures& frame) {
  const prometheus::Labels museum{{"museum", series_->label_of(frame.museum)}};
  switch (frame.outcome) {
    case FrameFigures::Outcome::kWhole:
      series_->frames.Add(museum).Increment();
      break;
    case FrameFigures::Outcome::kRefined:
      series_->refined.Add(museum).Increment();
      break;
    case FrameFigures::Outcome::kLate:
      series_->late.Add(museum).Increment();
      break;
    case FrameFigures::Outcome::kGivenUp:
      series_->given_up.Add(museum).Increment();
      break;
  }
  series_->bytes.Add(museum).Increment(static_cast<double>(frame.bytes));
  series_->rays.Increment(static_cast<double>(frame.rays));
  if (frame.reassigned) series_->reassigned.Increment();
  series_->moved.Increment(frame.moved);
}

void FarmMetrics::add_stage(const std::string& stage, double seconds) {
  series_->stages.Add({{"stage", stage}}, kSeconds).Observe(seconds);
}

void FarmMetrics::session_opened(const std::string& museum) {
  const prometheus::Labels labels{{"museum", series_->label_of(museum)}};
  series_->sessions.Add(labels).Increment();
  // Rates need a first value, so counters start at 0 instead of being absent.
  for (Family<Counter>* const family : {&series_->frames, &series_->refined, &series_->late, &series_->given_up}) {
    family->Add(labels);
  }
}

void FarmMetrics::session_refused(ErrorCode reason) {
  series_->refusals.Add({{"reason", word_for(reason)}}).Increment();
}
void FarmMetrics::node_sent_away() { series_->sent_away.Increment(); }
void FarmMetrics::scene_bytes_sent(std::uint64_t so_far) {
  series_->scene_bytes.Increment(static_cast<double>(so_far) - series_->scene_bytes.Value());
}

void FarmMetrics::show(FarmOverview overview) {
  const std::lock_guard lock(series_->mutex);
  series_->overview = std::move(overview);
}

std::string FarmMetrics::text() const {
  std::vector<MetricFamily> families = series_->registry.Collect();
  Gauges gauges;
  {
    const std::lock_guard lock(series_->mutex);
    const FarmOverview& farm = series_->overview;
    gauges.add("cyclorama_build_info", "Running version");
    gauges.sample({{"version", CYCLORAMA_VERSION}}, 1.0);
    gauges.add("cyclorama_healthy", "1 if every session has nodes with its scene");
    gauges.sample({}, farm.healthy ? 1.0 : 0.0);
    gauges.add("cyclorama_nodes", "Nodes connected");
    gauges.sample({}, static_cast<double>(farm.nodes.size()));
    gauges.add("cyclorama_scene_nodes", "Nodes that have the scene");
    for (const auto& [scene, nodes] : farm.scene_nodes) {
      gauges.sample({{"scene", scene}}, static_cast<double>(nodes));
    }
    series_->add_sessions(&gauges);
    add_nodes(farm.nodes, &gauges);
  }
  std::vector<MetricFamily> made = std::move(gauges).take();
  std::ranges::move(made, std::back_inserter(families));
  std::erase_if(families, [](const MetricFamily& family) { return family.metric.empty(); });
  std::ranges::sort(families, {}, &MetricFamily::name);
  return prometheus::TextSerializer().Serialize(families);
}

}  // namespace cyclorama::watch
