// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/picture_fetch.h"

#include <utility>

namespace cyclorama::tour {

Result<std::unique_ptr<PictureFetch>> PictureFetch::start(client::FarmClientOptions options, wire::View view) {
  view.set_number(1);
  std::unique_ptr<PictureFetch> fetch(new PictureFetch(std::move(view)));
  TRY_ASSIGN(fetch->farm_, client::FarmClient::start(std::move(options), *fetch));
  fetch->farm_->request(fetch->wanted_);
  return fetch;
}

PictureFetch::~PictureFetch() {
  if (farm_ != nullptr) farm_->stop();
}

std::optional<Result<KeptPicture>> PictureFetch::take_result() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

void PictureFetch::on_opened(const wire::SceneDescription&) {}

void PictureFetch::on_lost(const Error& reason) {
  const std::lock_guard lock(mutex_);
  if (!result_) result_ = Result<KeptPicture>(reason);
}

void PictureFetch::on_begin(const wire::View& view) {
  picture_ = {};
  picture_.view = view;
}

void PictureFetch::on_tile(wire::Tile tile) { picture_.tiles.push_back(std::move(tile)); }

void PictureFetch::on_end(const wire::FrameEnd& end) {
  // A farm that refines sends more frames of the view until its reference is reached.
  if (!end.complete() || end.samples() < end.reference_samples()) return;
  picture_.end = end;
  picture_.end.clear_stages();
  const std::lock_guard lock(mutex_);
  if (!result_) result_ = Result<KeptPicture>(std::exchange(picture_, {}));
}

}  // namespace cyclorama::tour
