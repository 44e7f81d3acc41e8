// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/v4l2/pixel_formats.h"

#include <linux/videodev2.h>

namespace cyclorama::camera {

std::optional<PixelLayout> layout_of_v4l2(std::uint32_t fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_GREY:
      return PixelLayout::kGrey8;
    case V4L2_PIX_FMT_NV12:
    case V4L2_PIX_FMT_NV21:
    case V4L2_PIX_FMT_NV16:
    case V4L2_PIX_FMT_NV61:
    case V4L2_PIX_FMT_NV24:
    case V4L2_PIX_FMT_NV42:
    case V4L2_PIX_FMT_YUV420:
    case V4L2_PIX_FMT_YVU420:
    case V4L2_PIX_FMT_YUV422P:
    case V4L2_PIX_FMT_YUV411P:
    case V4L2_PIX_FMT_YUV410:
    case V4L2_PIX_FMT_YVU410:
      return PixelLayout::kPlanarYuv;
    case V4L2_PIX_FMT_Y16:
      return PixelLayout::kGrey16;
    case V4L2_PIX_FMT_Y12:
      return PixelLayout::kGrey12;
    case V4L2_PIX_FMT_Y10:
      return PixelLayout::kGrey10;
    case V4L2_PIX_FMT_YUYV:
    case V4L2_PIX_FMT_YVYU:
      return PixelLayout::kYuyv;
    case V4L2_PIX_FMT_UYVY:
    case V4L2_PIX_FMT_VYUY:
      return PixelLayout::kUyvy;
    case V4L2_PIX_FMT_MJPEG:
    case V4L2_PIX_FMT_JPEG:
      return PixelLayout::kJpeg;
    default:
      return std::nullopt;
  }
}

ColourCode colour_of_v4l2(std::uint32_t fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_YUYV:
    case V4L2_PIX_FMT_UYVY:
      return {Chroma::kBetween, false, false};
    case V4L2_PIX_FMT_YVYU:
    case V4L2_PIX_FMT_VYUY:
      return {Chroma::kBetween, true, false};
    case V4L2_PIX_FMT_NV12:
      return {Chroma::kPairs, false, false};
    case V4L2_PIX_FMT_NV21:
      return {Chroma::kPairs, true, false};
    case V4L2_PIX_FMT_MJPEG:
    case V4L2_PIX_FMT_JPEG:
      return {Chroma::kInJpeg, false, true};
    default:
      return {};
  }
}

}  // namespace cyclorama::camera
