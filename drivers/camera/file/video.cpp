// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/file/video.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/error.h>
#include <libavutil/log.h>
#include <libswscale/swscale.h>
}

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "common/image/image_file.h"

namespace cyclorama::camera {
namespace {

/// Fallback for a container without a rate: most cameras record at this rate.
constexpr double kUsualFramesPerSecond = 30.0;

struct CloseFormat {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
};
struct FreeCodec {
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
};
struct FreeFrame {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct FreeScaler {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};

Error bad(const std::filesystem::path& path, const std::string& what) {
  return Error(ErrorCode::kBadData, fmt::format("video '{}': {}", path.string(), what));
}

std::string text_of(int av_error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(av_error, text.data(), text.size());
  return text.data();
}

}  // namespace

struct Video::Decoder {
  std::unique_ptr<AVFormatContext, CloseFormat> format;
  std::unique_ptr<AVCodecContext, FreeCodec> codec;
  std::unique_ptr<AVFrame, FreeFrame> frame{av_frame_alloc()};
  std::unique_ptr<AVPacket, FreePacket> packet{av_packet_alloc()};
  std::unique_ptr<SwsContext, FreeScaler> scaler;
  int stream = -1;
  bool ended = false;  ///< True once the codec has all packets; it may still hold pictures.

  Status open(const std::filesystem::path& path);
  Status open_codec(const std::filesystem::path& path);
  /// Decodes the next picture into `frame`; returns false at the end.
  Result<bool> decode(const std::filesystem::path& path);
  Status to_grey(const std::filesystem::path& path, GreyImage* ret_grey);
};

Status Video::Decoder::open(const std::filesystem::path& path) {
  // Only plain files are allowed: playlists and network references must not be followed.
  AVDictionary* options = nullptr;
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  av_dict_set(&options, "format_whitelist", "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi", 0);
  AVFormatContext* opened = nullptr;
  const int error = avformat_open_input(&opened, ("file:" + path.string()).c_str(), nullptr, &options);
  av_dict_free(&options);
  if (error < 0) {
    return bad(path, fmt::format("{}; a photo must be PNG or JPEG, a video MP4, Matroska or AVI", text_of(error)));
  }
  format.reset(opened);
  if (const int found = avformat_find_stream_info(opened, nullptr); found < 0) return bad(path, text_of(found));
  return open_codec(path);
}

Status Video::Decoder::open_codec(const std::filesystem::path& path) {
  const AVCodec* decoder = nullptr;
  stream = av_find_best_stream(format.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (stream < 0 || decoder == nullptr) return bad(path, "it holds no pictures that this machine can decode");
  codec.reset(avcodec_alloc_context3(decoder));
  CHECK(codec != nullptr && frame != nullptr && packet != nullptr);
  const AVStream* const video = format->streams[static_cast<unsigned>(stream)];
  int error = avcodec_parameters_to_context(codec.get(), video->codecpar);
  codec->max_pixels = static_cast<std::int64_t>(kPhotoLimitPx);
  if (error >= 0) error = avcodec_open2(codec.get(), decoder, nullptr);
  if (error < 0) return bad(path, text_of(error));
  return Done{};
}

Result<bool> Video::Decoder::decode(const std::filesystem::path& path) {
  while (true) {
    const int received = avcodec_receive_frame(codec.get(), frame.get());
    if (received == 0) return true;
    if (received == AVERROR_EOF) return false;
    if (received != AVERROR(EAGAIN)) return bad(path, text_of(received));
    if (ended) return false;
    const int read = av_read_frame(format.get(), packet.get());
    if (read < 0) {
      // A truncated file ends where it is cut.
      ended = true;
      avcodec_send_packet(codec.get(), nullptr);
      continue;
    }
    if (packet->stream_index == stream) {
      const int sent = avcodec_send_packet(codec.get(), packet.get());
      av_packet_unref(packet.get());
      if (sent < 0) return bad(path, text_of(sent));
    }
    av_packet_unref(packet.get());
  }
}

Status Video::Decoder::to_grey(const std::filesystem::path& path, GreyImage* ret_grey) {
  const int width = frame->width;
  const int height = frame->height;
  if (width <= 0 || height <= 0 || static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > kPhotoLimitPx) {
    return bad(path, fmt::format("its pictures are {}x{}", width, height));
  }
  // sws_getCachedContext() frees or reuses the old context.
  scaler.reset(sws_getCachedContext(scaler.release(), width, height, static_cast<AVPixelFormat>(frame->format), width,
                                    height, AV_PIX_FMT_GRAY8, SWS_POINT, nullptr, nullptr, nullptr));
  if (scaler == nullptr) return bad(path, "its pixels cannot be converted to grey");
  if (ret_grey->width() != width || ret_grey->height() != height) *ret_grey = GreyImage(width, height);
  std::uint8_t* const rows[] = {ret_grey->data().data()};
  const int strides[] = {width};
  if (sws_scale(scaler.get(), frame->data, frame->linesize, 0, height, rows, strides) != height) {
    return bad(path, "its pixels cannot be converted to grey");
  }
  return Done{};
}

Video::Video() = default;
Video::~Video() = default;

Result<std::unique_ptr<ImageSequence>> Video::open(const std::filesystem::path& path) {
  // Failures are returned as an Error; libav's log would only repeat them on standard error.
  av_log_set_level(AV_LOG_QUIET);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return Error(ErrorCode::kNotFound, fmt::format("opening '{}': no such file", path.string()));
  }
  std::unique_ptr<Video> video(new Video());
  video->path_ = path;
  TRY(video->reopen());
  const AVStream* const stream = video->decoder_->format->streams[static_cast<unsigned>(video->decoder_->stream)];
  const double rate = av_q2d(stream->avg_frame_rate);
  video->frames_per_second_ = rate >= 0.01 && rate <= 1000.0 ? rate : kUsualFramesPerSecond;
  TRY_ASSIGN(const std::optional<GreyImage> first, video->picture(0));
  if (!first) return bad(path, "it holds no picture");
  return std::unique_ptr<ImageSequence>(std::move(video));
}

Status Video::reopen() {
  decoder_ = std::make_unique<Decoder>();
  next_ = 0;
  return decoder_->open(path_);
}

Result<std::optional<GreyImage>> Video::picture(std::uint64_t index) {
  if (count_ && index >= *count_) return std::optional<GreyImage>{};
  if (next_ == index + 1) return std::optional<GreyImage>(newest_);
  if (next_ > index) TRY(reopen());
  while (next_ <= index) {
    TRY_ASSIGN(const bool more, decoder_->decode(path_));
    if (!more) {
      count_ = next_;
      return std::optional<GreyImage>{};
    }
    ++next_;
  }
  TRY(decoder_->to_grey(path_, &newest_));
  return std::optional<GreyImage>(newest_);
}

}  // namespace cyclorama::camera
