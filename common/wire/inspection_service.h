// SPDX-License-Identifier: Apache-2.0
/// A process's status for the operator: stage times, gauges, facts and live pictures, updated from any thread.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/base/clock.h"
#include "common/base/percentiles.h"
#include "common/image/image.h"
#include "common/wire/inspection.grpc.pb.h"

namespace cyclorama {

/// Serves the status. To be registered with the process's WireServer. Thread-safe. Pictures are encoded only on
/// request.
class InspectionService final : public wire::Inspection::Service {
 public:
  explicit InspectionService(std::string process);

  void set_state(std::string sentence, bool healthy);
  void add_stage_time(const std::string& stage, Duration duration);
  void set_gauge(const std::string& name, double value);
  /// Adds to a gauge that starts at 0.
  void count(const std::string& name, double increment = 1.0);
  void set_fact(const std::string& name, std::string value);
  /// Replaces the table of the same name.
  void set_table(wire::Table table);
  /// Replaces the picture of the same name.
  void set_picture(const std::string& name, std::shared_ptr<const RgbImage> picture);
  /// Returns false if the picture was not requested in the last 3 seconds, so that it need not be made. From the first
  /// call on, GetStatus lists the picture's name.
  [[nodiscard]] bool is_watched(const std::string& picture);
  [[nodiscard]] wire::ProcessStatus status() const;

 private:
  grpc::Status GetStatus(grpc::ServerContext* context, const wire::StatusRequest* request,
                         wire::ProcessStatus* reply) override;
  grpc::Status GetPicture(grpc::ServerContext* context, const wire::PictureRequest* request,
                          wire::Picture* reply) override;
  struct ShownPicture {
    std::shared_ptr<const RgbImage> newest;
    TimePoint asked_at{};
  };

  const std::string process_;
  const TimePoint started_at_;
  mutable std::mutex mutex_;
  std::string state_ = "starting";
  bool healthy_ = false;
  std::map<std::string, Percentiles> stages_;
  std::map<std::string, double> gauges_;
  std::map<std::string, std::string> facts_;
  std::map<std::string, wire::Table> tables_;
  std::map<std::string, ShownPicture> pictures_;
};

}  // namespace cyclorama
