// uvc_sim [options]: a USB camera that the kernel's own uvcvideo drives, attached through vhci-hcd. Prints the path of
// its video node when it is there, and stays until standard input is closed; SIGUSR1 pulls the cable.
//   --latency N  --noise  --seed N  --max-exposure N (100 us)  --log FILE
//   --no-manual-exposure  --refuse-exposure  --silent-exposure  --damage-every N  --lose-every N
//   --unplug-at-frame N  --freeze-at-frame N
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>

#include "tests/camera/uvc/uvc_camera.h"

namespace {

std::atomic<bool> unplug_asked{false};

/// The node that captures, once the kernel has made it: a UVC camera has a second one, for metadata.
std::string video_node() {
  const std::filesystem::path host = "/sys/devices/platform/vhci_hcd.0", all = "/sys/class/video4linux";
  if (!std::filesystem::exists(all)) return "";
  for (const auto& entry : std::filesystem::directory_iterator(all)) {
    int index = -1;
    std::ifstream(entry.path() / "index") >> index;
    const std::string device = std::filesystem::canonical(entry.path()).string();
    const std::string node = "/dev/" + entry.path().filename().string();
    if (index == 0 && device.find("/vhci_hcd.0/") != std::string::npos && access(node.c_str(), R_OK) == 0) return node;
  }
  return "";
}

bool input_is_closed() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  return poll(&input, 1, 0) > 0;
}

int run(int argc, char** argv) {
  hdr::sim::SensorOptions sensor;
  hdr::sim::Faults faults;
  std::string log;
  int i = 1;
  const auto value = [&] {
    if (++i >= argc) throw std::runtime_error(std::string(argv[i - 1]) + " needs a value");
    return std::string(argv[i]);
  };
  const std::map<std::string, std::function<void()>> options = {
      {"--latency", [&] { sensor.latency = std::stoi(value()); }},
      {"--noise", [&] { sensor.noise = true; }},
      {"--seed", [&] { sensor.seed = std::stoull(value()); }},
      {"--max-exposure", [&] { sensor.max_exposure_100us = static_cast<std::uint32_t>(std::stoul(value())); }},
      {"--log", [&] { log = value(); }},
      {"--no-manual-exposure", [&] { faults.no_manual_exposure = true; }},
      {"--refuse-exposure", [&] { faults.exposure_refused = true; }},
      {"--silent-exposure", [&] { faults.exposure_silent = true; }},
      {"--damage-every", [&] { faults.damaged_every = std::stoi(value()); }},
      {"--lose-every", [&] { faults.lost_every = std::stoi(value()); }},
      {"--freeze-at-frame", [&] { faults.freeze_at_frame = std::stoi(value()); }},
      {"--unplug-at-frame", [&] { faults.unplug_at_frame = std::stoi(value()); }},
  };
  for (; i < argc; ++i) {
    const auto option = options.find(argv[i]);
    if (option == options.end()) throw std::runtime_error(std::string("unknown option ") + argv[i]);
    option->second();
  }
  std::signal(SIGUSR1, [](int) { unplug_asked = true; });
  hdr::sim::UvcCamera camera(sensor, faults, log);
  const auto start = std::chrono::steady_clock::now();
  bool announced = false, plugged = true;
  while (!input_is_closed()) {
    if (plugged && unplug_asked) camera.unplug();
    constexpr double kTick = 0.02;
    if (plugged)
      plugged = camera.serve(kTick);
    else
      usleep(20'000);
    if (!announced) {
      const std::string node = video_node();
      if (!node.empty()) std::cout << node << std::endl;
      announced = !node.empty();
      if (!announced && std::chrono::steady_clock::now() - start > std::chrono::seconds(30)) {
        throw std::runtime_error("no video node after 30 s; is uvcvideo loaded?");
      }
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "uvc_sim: " << error.what() << '\n';
    return 1;
  }
}
