#include "tests/camera/simulator.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "capture/v4l2/v4l2_controls.h"
#include "tests/camera/uvc/scene.h"
#include "tests/support/support.h"

namespace hdr::test {
namespace {

/// libcamera finds what udevd knows: waits until it has seen what was plugged or pulled.
void let_udev_settle() {
  if (!std::filesystem::exists("/run/udev/control")) return;
  const CommandResult result = run_command({"udevadm", "settle", "--timeout=60"});
  if (result.exit_code != 0) throw std::runtime_error("udevadm settle: " + result.err);
}

}  // namespace

Simulator::Simulator(std::vector<std::string> options) {
  char name[] = "/tmp/uvc_sim.XXXXXX";
  close(mkstemp(name));
  log_ = name;
  int in[2], out[2];
  if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("no pipes");
  options.insert(options.begin(), HDR_UVC_SIM);
  options.insert(options.end(), {"--log", log_});
  std::vector<char*> arguments;
  for (std::string& option : options) arguments.push_back(option.data());
  arguments.push_back(nullptr);
  process_ = fork();
  if (process_ == 0) {
    dup2(in[0], STDIN_FILENO);
    dup2(out[1], STDOUT_FILENO);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  close(in[0]);
  close(out[1]);
  to_child_ = in[1];
  for (char c = 0; read(out[0], &c, 1) == 1 && c != '\n';) node_ += c;
  close(out[0]);
  if (node_.empty()) throw std::runtime_error("the simulated camera did not come up");
  let_udev_settle();
}

Simulator::~Simulator() {
  close(to_child_);
  waitpid(process_, nullptr, 0);
  for (int k = 0; k < 200 && std::filesystem::exists(node_); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::filesystem::remove(log_);
  let_udev_settle();
}

void Simulator::unplug() const {
  kill(process_, SIGUSR1);
}

std::vector<std::int64_t> Simulator::settings() const {
  v4l2::Device device("v4l2:" + node_, node_);
  const v4l2::Controls controls(device);
  std::vector<std::int64_t> values;
  for (const std::uint32_t id : {V4L2_CID_EXPOSURE_AUTO, V4L2_CID_EXPOSURE_AUTO_PRIORITY, V4L2_CID_AUTO_WHITE_BALANCE,
                                 V4L2_CID_WHITE_BALANCE_TEMPERATURE, V4L2_CID_GAIN}) {
    values.push_back(controls.get(id));
  }
  return values;
}

std::vector<Simulator::Used> Simulator::used() const {
  std::vector<Used> all;
  std::ifstream log(log_);
  Used one{};
  char comma;
  while (log >> one.stream >> comma >> one.sequence >> comma >> one.exposure_100us >> comma >> one.gain_16ths) {
    all.push_back(one);
  }
  return all;
}

Image<float> simulated_scene(Size size) {
  Image<float> scene(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto light = sim::patch_radiance(sim::patch_column(x, size.width), sim::patch_row(y, size.height));
      for (int k = 0; k < 3; ++k) scene.row(y)[3 * x + k] = light[static_cast<std::size_t>(k)];
    }
  }
  return scene;
}

double median_error(View<const float> map, View<const float> truth) {
  std::vector<double> ratios;
  for (int y = 0; y < truth.height(); ++y) {
    for (int k = 0; k < truth.width() * 3; ++k) ratios.push_back(map.row(y)[k] / truth.row(y)[k]);
  }
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const double scale = median(ratios);
  for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1);
  return median(ratios);
}

}  // namespace hdr::test
