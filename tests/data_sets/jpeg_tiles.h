// SPDX-License-Identifier: Apache-2.0
/// Frames as a farm sends them: a view and real JPEG tiles of a picture.
#pragma once

#include <algorithm>
#include <vector>

#include "common/image/jpeg.h"
#include "common/wire/convert.h"
#include "common/wire/museum.pb.h"

namespace cyclorama {

inline wire::View view_of(std::uint64_t number, const Projection& picture, double heading_rad = 0.0) {
  wire::View view;
  view.set_number(number);
  view.set_heading_rad(heading_rad);
  to_wire(picture, view.mutable_panorama());
  view.set_samples(1);
  view.set_jpeg_quality(95);
  return view;
}
inline wire::View view_of(std::uint64_t number, const PictureShape& panorama, double heading_rad = 0.0) {
  return view_of(number, Projection{panorama, {}}, heading_rad);
}

/// Cuts a picture into tiles of at most `side_px`, a multiple of 16.
inline std::vector<wire::Tile> tiles_of(std::uint64_t number, const RgbImage& picture, int side_px = 64) {
  std::vector<wire::Tile> tiles;
  JpegEncoder encoder;
  for (int y = 0; y < picture.height(); y += side_px) {
    for (int x = 0; x < picture.width(); x += side_px) {
      const int width = std::min(side_px, picture.width() - x);
      const int height = std::min(side_px, picture.height() - y);
      const auto jpeg = encoder.encode(picture.at(x, y), width, height, picture.row_values(), {95, false});
      CHECK(jpeg.has_value());
      wire::Tile tile;
      tile.set_view_number(number);
      tile.set_x_px(static_cast<std::uint32_t>(x));
      tile.set_y_px(static_cast<std::uint32_t>(y));
      tile.set_width_px(static_cast<std::uint32_t>(width));
      tile.set_height_px(static_cast<std::uint32_t>(height));
      tile.set_jpeg(jpeg->data(), jpeg->size());
      tiles.push_back(std::move(tile));
    }
  }
  return tiles;
}

inline wire::FrameEnd end_of(std::uint64_t number, std::size_t tiles, bool complete = true) {
  wire::FrameEnd end;
  end.set_view_number(number);
  end.set_tiles(static_cast<std::uint32_t>(tiles));
  end.set_complete(complete);
  return end;
}

/// Returns the messages of one complete frame, in order.
inline std::vector<wire::ShowMessage> frame_messages(std::uint64_t number, const RgbImage& picture,
                                                     const Projection& projection, double heading_rad = 0.0,
                                                     int side_px = 64) {
  std::vector<wire::ShowMessage> messages(1);
  *messages[0].mutable_begin() = view_of(number, projection, heading_rad);
  for (wire::Tile& tile : tiles_of(number, picture, side_px)) *messages.emplace_back().mutable_tile() = std::move(tile);
  const std::size_t tiles = messages.size() - 1;
  *messages.emplace_back().mutable_end() = end_of(number, tiles);
  return messages;
}
inline std::vector<wire::ShowMessage> frame_messages(std::uint64_t number, const RgbImage& picture,
                                                     const PictureShape& panorama, double heading_rad = 0.0,
                                                     int side_px = 64) {
  return frame_messages(number, picture, Projection{panorama, {}}, heading_rad, side_px);
}

}  // namespace cyclorama
