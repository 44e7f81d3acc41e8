// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/headless/headless_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "drivers/output/gl_objects.h"
#include "drivers/output/headless/gl_context.h"
#include "drivers/output/headless/refresh_schedule.h"
#include "drivers/output/shared_picture.h"

namespace cyclorama::output {
namespace {

constexpr double kMaxHz = 1000.0;
constexpr double kMinHz = 0.1;

/// One head: its GL framebuffer and the destination of its pixels.
struct Head {
  GlRenderbuffer colour;
  GlFramebuffer framebuffer;
  std::vector<SharedPictureWriter> shared;  // At most one.
  RgbaImage read_back;
  RgbImage picture;
  bool is_drawn = false;  // Drawn since the last present().
  bool is_new = false;    // True if this present() shows a new picture.
};

class HeadlessOutput final : public Output {
 public:
  HeadlessOutput(std::unique_ptr<GlContext> context, const HeadlessOptions& options, const Clock& clock)
      : context_(std::move(context)), options_(options), clock_(clock), schedule_(options.refresh_hz, clock.now()) {}

  Status make_heads() {
    for (const HeadMode& mode : options_.heads) {
      TRY_ASSIGN(Head head, make_head(mode));
      heads_.push_back(std::move(head));
    }
    shown_.resize(heads_.size());
    return Done{};
  }

  [[nodiscard]] const std::vector<HeadMode>& heads() const override { return options_.heads; }
  [[nodiscard]] double refresh_hz() const override { return options_.refresh_hz; }
  [[nodiscard]] std::string kind() const override { return context_->kind(); }
  [[nodiscard]] const Gl& gl() const override { return context_->gl(); }
  [[nodiscard]] const std::vector<HeadShown>& shown() const override { return shown_; }

  Status wait_for_refresh() override {
    const RefreshSchedule::Refresh refresh = schedule_.next(clock_.now());
    refresh_ = refresh.number;
    std::this_thread::sleep_for(refresh.at - clock_.now());
    return Done{};
  }

  Status draw_to(std::size_t head) override {
    CHECK(head < heads_.size());
    gl().BindFramebuffer(GL_FRAMEBUFFER, heads_[head].framebuffer.id());
    gl().Viewport(0, 0, options_.heads[head].width_px, options_.heads[head].height_px);
    heads_[head].is_drawn = true;
    return Done{};
  }

  Result<Presented> present() override {
    const bool is_awake = options_.is_awake == nullptr || *options_.is_awake;
    const bool is_turning = std::exchange(was_awake_, is_awake) != is_awake;
    for (Head& head : heads_) {
      head.is_new = is_awake ? head.is_drawn || is_turning : is_turning;
      head.is_drawn = false;
      if (!head.is_new || head.shared.empty()) continue;
      if (is_awake) {
        read_back(&head);
      } else {
        std::ranges::fill(head.picture.data(), std::uint8_t{0});
      }
    }
    gl().Finish();
    TRY(gl().check("presenting"));
    const Presented presented{refresh_, clock_.now()};
    for (std::size_t i = 0; i < heads_.size(); ++i) {
      if (heads_[i].is_new && !heads_[i].shared.empty())
        heads_[i].shared.front().publish(heads_[i].picture, {0, presented.refresh, presented.at});
      const HeadShown::Light lit = heads_[i].is_new ? HeadShown::Light::kNew : HeadShown::Light::kSame;
      shown_[i] = {is_awake ? lit : HeadShown::Light::kDark, presented.at, options_.refresh_hz, 8};
    }
    return presented;
  }

 private:
  Result<Head> make_head(const HeadMode& mode) {
    GLint largest = 0;
    gl().GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (mode.width_px < 1 || mode.height_px < 1 || mode.width_px > largest || mode.height_px > largest) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("head '{}' of {}x{} pixels cannot be drawn; a side is 1 to {}", mode.name, mode.width_px,
                               mode.height_px, largest));
    }
    Head head{GlRenderbuffer(gl()), GlFramebuffer(gl()), {}, {}, {}, false, false};
    gl().BindRenderbuffer(GL_RENDERBUFFER, head.colour.id());
    gl().RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, mode.width_px, mode.height_px);
    gl().BindFramebuffer(GL_FRAMEBUFFER, head.framebuffer.id());
    gl().FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, head.colour.id());
    if (gl().CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      return Error(ErrorCode::kUnavailable, fmt::format("head '{}': the driver cannot draw into memory", mode.name));
    }
    gl().ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    gl().Clear(GL_COLOR_BUFFER_BIT);
    if (!options_.run_dir.empty()) {
      TRY_ASSIGN(
          SharedPictureWriter writer,
          SharedPictureWriter::create(shared_picture_path(options_.run_dir, mode.name), mode.width_px, mode.height_px));
      head.shared.push_back(std::move(writer));
      head.read_back = RgbaImage(mode.width_px, mode.height_px);
      head.picture = RgbImage(mode.width_px, mode.height_px);
    }
    TRY(gl().check(fmt::format("making head '{}'", mode.name)));
    return head;
  }

  void read_back(Head* head) {
    gl().BindFramebuffer(GL_FRAMEBUFFER, head->framebuffer.id());
    gl().PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl().ReadPixels(0, 0, head->read_back.width(), head->read_back.height(), GL_RGBA, GL_UNSIGNED_BYTE,
                    head->read_back.data().data());
    to_picture(head->read_back, &head->picture);
  }

  std::unique_ptr<GlContext> context_;  // First member, so that the heads' GL objects are destroyed before it.
  HeadlessOptions options_;
  const Clock& clock_;
  RefreshSchedule schedule_;
  std::vector<Head> heads_;
  std::vector<HeadShown> shown_;
  bool was_awake_ = true;
  std::uint64_t refresh_ = 0;
};

Result<std::unique_ptr<GlContext>> make_context(HeadlessOptions::Renderer renderer) {
  if (renderer == HeadlessOptions::Renderer::kOsMesa) return make_osmesa_context();
  auto egl = make_egl_context();
  if (egl || renderer == HeadlessOptions::Renderer::kEgl) return egl;
  auto osmesa = make_osmesa_context();
  if (osmesa) return osmesa;
  return Error(ErrorCode::kUnavailable, fmt::format("{}; {}; install Debian's libegl-mesa0 and libgl1-mesa-dri",
                                                    egl.error().message(), osmesa.error().message()));
}

}  // namespace

Result<std::unique_ptr<Output>> open_headless_output(const HeadlessOptions& options, const Clock& clock) {
  if (options.heads.empty()) return Error(ErrorCode::kInvalidArgument, "an output needs at least one head");
  if (!(options.refresh_hz >= kMinHz && options.refresh_hz <= kMaxHz)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a refresh rate of {} Hz; it must be {} to {}", options.refresh_hz, kMinHz, kMaxHz));
  }
  TRY_ASSIGN(std::unique_ptr<GlContext> context, make_context(options.renderer));
  auto output = std::make_unique<HeadlessOutput>(std::move(context), options, clock);
  TRY(output->make_heads());
  return std::unique_ptr<Output>(std::move(output));
}

}  // namespace cyclorama::output
