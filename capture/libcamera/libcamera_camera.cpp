#include "capture/libcamera/libcamera_camera.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "capture/internal/deadline_worker.h"
#include "capture/internal/order_of_calls.h"
#include "capture/internal/restore_on_signal.h"
#include "capture/libcamera/libcamera_controls.h"
#include "capture/libcamera/libcamera_formats.h"
#include "capture/libcamera/libcamera_stream.h"
#include "capture/libcamera/shared_manager.h"
#include "capture/v4l2/formats.h"
#include "capture/v4l2/v4l2_device.h"
#include "capture/v4l2/v4l2_uri.h"

namespace hdr {
namespace {

using Clock = std::chrono::steady_clock;
using Kind = CameraError::Kind;
using v4l2::During;

constexpr std::string_view kScheme = "libcamera:";
/// For calls that talk to the device.
constexpr std::chrono::milliseconds kPatience{4000};

/// libcamera leaves out devices that it may not open.
bool some_device_is_forbidden() {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", none)) {
    if (!entry.path().filename().string().starts_with("media")) continue;
    const int file = open(entry.path().c_str(), O_RDWR | O_CLOEXEC);
    if (file < 0 && errno == EACCES) return true;
    if (file >= 0) close(file);
  }
  return false;
}

std::shared_ptr<libcamera::Camera> find_camera(libcamera::CameraManager& all, const std::string& id,
                                               const std::string& uri) {
  for (const auto& camera : all.cameras()) {
    if (id.empty() || camera->id() == id) return camera;
  }
  if (some_device_is_forbidden()) throw v4l2::error_of(EACCES, During::kOpen, uri, "opening it");
  throw CameraError(Kind::kNotSupported, uri + ": libcamera finds no such camera; hdr cameras lists those it does");
}

class LibcameraCamera : public CameraDevice {
 public:
  LibcameraCamera(const std::string& uri, v4l2::Uri wanted);
  ~LibcameraCamera() override;

  Capabilities capabilities() const override { return capabilities_; }
  FrameFormat configure(const Configuration& configuration) override;
  void start(const ExposureSetting& first) override;
  void set(const ExposureSetting& setting) override;
  Frame next_frame(Clock::time_point deadline) override;
  void stop() override;

 private:
  template <typename T>
  T within_patience(const std::string& what, std::function<T()> call);
  void require(const std::string& what, std::function<int()> call);
  void enumerate_formats();
  bool try_configuration(const FrameFormat& format);

  v4l2::Uri wanted_;
  Capabilities capabilities_;
  internal::DeadlineWorker worker_;
  std::shared_ptr<libcamera::CameraManager> manager_;
  std::shared_ptr<libcamera::Camera> camera_;
  std::shared_ptr<libcamera::CameraConfiguration> configuration_;
  std::optional<FrameFormat> format_;
  ExposureSetting setting_;
  std::shared_ptr<lc::Stream> stream_;
  std::optional<internal::RestoreOnSignal> restore_on_signal_;
};

template <typename T>
T LibcameraCamera::within_patience(const std::string& what, std::function<T()> call) {
  auto result = worker_.run<T>(std::move(call), Clock::now() + kPatience);
  if (!result) throw v4l2::error_of(ETIMEDOUT, During::kStream, capabilities_.uri, what);
  return std::move(*result);
}

void LibcameraCamera::require(const std::string& what, std::function<int()> call) {
  const int error = within_patience<int>(what, std::move(call));
  // It answers EACCES to calls in a state that is not theirs, as after the camera is gone.
  if (error == EACCES) throw v4l2::error_of(ENODEV, During::kStream, capabilities_.uri, what);
  if (error) throw v4l2::error_of(error, During::kStream, capabilities_.uri, what);
}

LibcameraCamera::LibcameraCamera(const std::string& uri, v4l2::Uri wanted) : wanted_(std::move(wanted)) {
  capabilities_.uri = uri;
  manager_ = within_patience<std::shared_ptr<libcamera::CameraManager>>("starting libcamera", lc::shared_manager);
  camera_ = find_camera(*manager_, wanted_.path, uri);
  const auto model = camera_->properties().get(libcamera::properties::Model);
  capabilities_.name = model ? std::string(*model) : camera_->id();
  lc::describe_exposure(*camera_, capabilities_);
  require("taking it", [camera = camera_] { return -camera->acquire(); });
  enumerate_formats();
}

LibcameraCamera::~LibcameraCamera() {
  stop();
  // All is let go before the answer, so that libcamera's last user is this thread.
  worker_.run<int>(
      [camera = std::move(camera_), configuration = std::move(configuration_), manager = manager_]() mutable {
        camera->release();
        configuration.reset();
        camera.reset();
        manager.reset();
        return 0;
      },
      Clock::now() + kPatience);
}

void LibcameraCamera::enumerate_formats() {
  for (const auto role : {libcamera::StreamRole::Raw, libcamera::StreamRole::StillCapture}) {
    const std::shared_ptr<libcamera::CameraConfiguration> offered = camera_->generateConfiguration({role});
    if (!offered || offered->empty()) continue;
    const libcamera::StreamFormats formats = offered->at(0).formats();
    for (const auto& pixels : formats.pixelformats()) {
      for (const auto& size : formats.sizes(pixels)) {
        auto format = lc::frame_format(pixels, {static_cast<int>(size.width), static_cast<int>(size.height)});
        if (!format || (wanted_.size && format->size != *wanted_.size)) continue;
        const v4l2::FormatCode* code = v4l2::find_format(format->pixels, format->cfa);
        if (wanted_.fourcc && (!code || code->fourcc != *wanted_.fourcc)) continue;
        if (is_bayer(format->pixels)) format->black_level = wanted_.black_level;
        if (std::ranges::find(capabilities_.formats, *format) == capabilities_.formats.end()) {
          capabilities_.formats.push_back(*format);
        }
      }
    }
  }
  std::ranges::stable_sort(capabilities_.formats, v4l2::better_for_brackets);
}

bool LibcameraCamera::try_configuration(const FrameFormat& format) {
  const auto role = is_bayer(format.pixels) ? libcamera::StreamRole::Raw : libcamera::StreamRole::StillCapture;
  std::shared_ptr<libcamera::CameraConfiguration> configuration = camera_->generateConfiguration({role});
  // USB cameras have raw formats, but not the role.
  if (!configuration || configuration->empty()) {
    configuration = camera_->generateConfiguration({libcamera::StreamRole::StillCapture});
  }
  if (!configuration || configuration->empty()) return false;
  libcamera::StreamConfiguration& stream = configuration->at(0);
  const auto pixels = *lc::libcamera_format(format.pixels, format.cfa);
  const libcamera::Size size(static_cast<unsigned>(format.size.width), static_cast<unsigned>(format.size.height));
  constexpr unsigned kBuffers = 4;
  stream.pixelFormat = pixels;
  stream.size = size;
  stream.bufferCount = std::max(stream.bufferCount, kBuffers);
  // What is adjusted in other ways is still what was asked.
  if (configuration->validate() == libcamera::CameraConfiguration::Invalid) return false;
  if (stream.pixelFormat != pixels || stream.size != size) return false;
  require("setting its format", [camera = camera_, configuration] { return -camera->configure(configuration.get()); });
  configuration_ = std::move(configuration);
  format_ = format;
  if (format.pixels != PixelFormat::kMjpeg)
    format_->stride_bytes = static_cast<std::ptrdiff_t>(configuration_->at(0).stride);
  return true;
}

FrameFormat LibcameraCamera::configure(const Configuration& configuration) {
  internal::require_configurable(capabilities_.uri, stream_ != nullptr);
  for (const FrameFormat& format : capabilities_.formats) {
    if (configuration.pixels && format.pixels != *configuration.pixels) continue;
    if (configuration.size && format.size != *configuration.size) continue;
    if (try_configuration(format)) return *format_;
  }
  throw CameraError(Kind::kNotSupported,
                    capabilities_.uri + ": the camera has no such format that we know; hdr cameras lists those it has");
}

void LibcameraCamera::start(const ExposureSetting& first) {
  internal::require_startable(capabilities_, stream_ != nullptr);
  if (!format_) configure({});
  setting_ = first;
  try {
    stream_ = std::make_shared<lc::Stream>(manager_, camera_, configuration_->at(0).stream());
  } catch (const std::runtime_error& error) {
    throw CameraError(Kind::kBusy,
                      capabilities_.uri + ": " + error.what() + "; another program may use the camera: close it");
  }
  try {
    require("starting it", [stream = stream_, controls = lc::manual(*camera_, capabilities_, first)] {
      return stream->start(controls);
    });
  } catch (...) {
    stream_.reset();
    throw;
  }
  constexpr std::chrono::milliseconds kLastRequest{500};
  restore_on_signal_.emplace(
      [stream = stream_, controls = lc::automatic(*camera_)] { stream->send_last(controls, kLastRequest); });
}

void LibcameraCamera::set(const ExposureSetting& setting) {
  internal::require_running(capabilities_.uri, stream_ != nullptr);
  setting_ = setting;
  stream_->ask(lc::manual(*camera_, capabilities_, setting));
}

Frame LibcameraCamera::next_frame(Clock::time_point deadline) {
  internal::require_running(capabilities_.uri, stream_ != nullptr);
  while (true) {
    Frame frame;
    std::optional<libcamera::ControlList> metadata;
    switch (stream_->next(deadline, frame, metadata)) {
      case lc::Stream::Arrival::kGone:
        throw v4l2::error_of(ENODEV, During::kStream, capabilities_.uri, "waiting for a frame");
      case lc::Stream::Arrival::kNothing:
        throw CameraError(Kind::kTimeout, capabilities_.uri + ": no frame came in time; is its cable sound?");
      case lc::Stream::Arrival::kFrame:
        break;
    }
    frame.format = *format_;
    if (is_bayer(frame.format.pixels)) {
      frame.format.black_level =
          lc::black_level(*metadata, bits_of(frame.format.pixels)).value_or(frame.format.black_level);
    }
    if (!frame.is_whole()) continue;
    frame.requested = setting_;
    frame.reported = lc::reported(*metadata);
    return frame;
  }
}

void LibcameraCamera::stop() {
  if (!stream_) return;
  restore_on_signal_.reset();
  constexpr std::chrono::milliseconds kLastRequest{500};
  if (!stream_->gone()) stream_->send_last(lc::automatic(*camera_), kLastRequest);
  worker_.run<int>(
      [stream = std::move(stream_)]() mutable {
        stream->stop();
        stream.reset();
        return 0;
      },
      Clock::now() + kPatience);
  stream_.reset();
}

}  // namespace

std::vector<CameraName> list_libcamera_cameras() {
  std::vector<CameraName> cameras;
  const auto all = lc::shared_manager();  // it outlives the cameras
  for (const auto& camera : all->cameras()) {
    const auto model = camera->properties().get(libcamera::properties::Model);
    cameras.push_back({std::string(kScheme) + camera->id(), model ? std::string(*model) : camera->id()});
  }
  return cameras;
}

std::unique_ptr<CameraDevice> open_libcamera_camera(const std::string& uri) {
  return std::make_unique<LibcameraCamera>(uri, v4l2::parse_uri(uri));
}

}  // namespace hdr
