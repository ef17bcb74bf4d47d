#include "tests/support/support.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "libhdr/core/random.h"

extern char** environ;

namespace hdr::test {
namespace fs = std::filesystem;

std::optional<fs::path> shared_data(const std::string& name) {
  fs::path path = fs::path(HDR_SHARED_DATA) / name;
  if (!fs::exists(path)) return std::nullopt;
  return path;
}

ScratchDir::ScratchDir() {
  std::string pattern = (fs::temp_directory_path() / "hdr-test-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("cannot make a scratch folder");
  path_ = pattern;
}

ScratchDir::~ScratchDir() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

namespace {

std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

CommandResult run_command(const std::vector<std::string>& arguments) {
  const ScratchDir scratch;
  const std::string out = (scratch / "out").string(), err = (scratch / "err").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed) return {127, "", "cannot start " + arguments[0]};
  int status = 0;
  waitpid(child, &status, 0);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, slurp(out), slurp(err)};
}

CommandResult run_hdr(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), HDR_BINARY);
  return run_command(arguments);
}

Image<float> test_scene(int width, int height, double stops, std::uint64_t seed) {
  Image<float> scene(width, height, 3);
  Random random(seed, 0);
  // A sum of a ramp across the range, a few waves and hard-edged boxes, in log2.
  struct Wave {
    double fx, fy, phase, size;
  };
  std::vector<Wave> waves;
  for (int k = 0; k < 12; ++k) {
    const double f = std::exp2(k * 0.5);
    waves.push_back({f * random.normal(), f * random.normal(), 6.28 * random.uniform(), 0.5 / std::sqrt(f)});
  }
  struct Box {
    double x0, y0, x1, y1, value[3];
  };
  std::vector<Box> boxes;
  for (int k = 0; k < 16; ++k) {
    const double x = random.uniform(), y = random.uniform();
    Box box{x, y, x + 0.05 + 0.15 * random.uniform(), y + 0.05 + 0.15 * random.uniform(), {}};
    const double grey = 2 * random.normal();
    for (double& v : box.value) v = grey + 0.3 * random.normal();
    boxes.push_back(box);
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width, v = (y + 0.5) / height;
      double wave = 0;
      for (const Wave& w : waves) wave += w.size * std::sin(6.28 * (w.fx * u + w.fy * v) + w.phase);
      for (int c = 0; c < 3; ++c) {
        double value = stops * (u - 0.5) + wave + 0.2 * (c - 1) * (v - 0.5);
        for (const Box& b : boxes) {
          if (u >= b.x0 && u < b.x1 && v >= b.y0 && v < b.y1) value += b.value[c];
        }
        scene(x, y, c) = static_cast<float>(std::exp2(value));
      }
    }
  }
  return scene;
}

}  // namespace hdr::test
