// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/result.h"
#include "common/wire/museum.pb.h"

namespace cyclorama::tour {

/// Requests about the tour's stops, the scene's lamps and the wall's captions; museum.proto states their errors. Called
/// on gRPC's threads, so implementations are thread-safe; they may read and write the tour's file, but wait for nobody.
class StopRequests {
 public:
  virtual ~StopRequests() = default;
  virtual Result<wire::StopList> list_stops() = 0;
  virtual Result<wire::GoToStopReply> go_to_stop(const wire::GoToStopRequest& request) = 0;
  virtual Result<wire::AddStopReply> add_stop(const wire::AddStopRequest& request) = 0;
  virtual Result<wire::UndoStopReply> undo_stop() = 0;
  virtual Result<wire::SetLampsReply> set_lamps(const wire::SetLampsRequest& request) = 0;
  virtual Result<wire::FetchPicturesReply> fetch_pictures() = 0;
  virtual Result<wire::SetCaptionsReply> set_captions(const wire::SetCaptionsRequest& request) = 0;

 protected:
  StopRequests() = default;
  StopRequests(const StopRequests&) = default;
  StopRequests& operator=(const StopRequests&) = default;
};

}  // namespace cyclorama::tour
