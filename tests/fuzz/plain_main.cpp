// Replays a reader's seeds, and files from folders named on the command line, as they are and with seeded mutations.
//   fuzz_radiance [--mutations N] [--seed S] [FILE or FOLDER...]
#include <algorithm>
#include <cstring>

#include "libhdr/core/random.h"
#include "tests/fuzz/harness.h"

namespace hdr::fuzz {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A few bytes changed, a part cut off, doubled, or a length field blown up: what damages files.
std::string mutated(std::string bytes, Random& random) {
  const auto place = [&] { return static_cast<std::size_t>(random.bits() % std::max<std::size_t>(1, bytes.size())); };
  const int changes = 1 + static_cast<int>(random.bits() % 6);
  for (int k = 0; k < changes && !bytes.empty(); ++k) {
    // Headers decide most: half of the changes fall there.
    const std::size_t at =
        random.bits() % 2 ? place() : std::min(place(), static_cast<std::size_t>(random.bits() % 256));
    switch (random.bits() % 8) {
      case 0:
        bytes.resize(place());
        break;
      case 1:
        bytes.insert(at, bytes.substr(place(), random.bits() % 64));
        break;
      case 2:
        bytes.erase(at, random.bits() % 16);
        break;
      case 3:
        for (std::size_t i = at; i < std::min(at + 4, bytes.size()); ++i) bytes[i] = '\xff';
        break;
      case 4:
        for (std::size_t i = at; i < std::min(at + 4, bytes.size()); ++i) bytes[i] = '\0';
        break;
      case 5:
        bytes[std::min(at, bytes.size() - 1)] ^= static_cast<char>(1 << random.bits() % 8);
        break;
      default:
        bytes[std::min(at, bytes.size() - 1)] = static_cast<char>(random.bits());
    }
  }
  return bytes;
}

void run(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::vector<std::string> inputs_of(const std::vector<fs::path>& named) {
  std::vector<std::string> inputs = seeds();
  const std::vector<std::string> wanted = extensions();
  std::vector<fs::path> files;
  for (const fs::path& path : named) {
    if (!fs::exists(path)) continue;  // a collection that is not here
    if (fs::is_regular_file(path)) files.push_back(path);
    if (!fs::is_directory(path)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(path)) {
      constexpr std::uintmax_t kSmall = 200000;  // mutations of large files are slow and find no more
      const bool is_wanted = std::count(wanted.begin(), wanted.end(), entry.path().extension().string()) > 0;
      if (entry.is_regular_file() && is_wanted && entry.file_size() < kSmall) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& path : files) inputs.push_back(bytes_of(path));
  return inputs;
}

int main(int argc, char** argv) {
  long mutations = 50;
  std::uint64_t seed = 1;
  std::vector<fs::path> named;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--mutations") == 0 && k + 1 < argc) {
      mutations = std::atol(argv[++k]);
    } else if (std::strcmp(argv[k], "--seed") == 0 && k + 1 < argc) {
      seed = static_cast<std::uint64_t>(std::atol(argv[++k]));
    } else {
      named.push_back(argv[k]);
    }
  }
  const std::vector<std::string> inputs = inputs_of(named);
  long runs = 0;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    run(inputs[k]);
    ++runs;
    Random random(seed, k);
    for (long m = 0; m < mutations; ++m, ++runs) {
      const std::string bytes = mutated(inputs[k], random);
      // Kept while it runs: what crashed is in the file.
      std::ofstream(fs::temp_directory_path() / ("hdr-fuzz-last-" + std::to_string(getpid())), std::ios::binary)
          << bytes;
      run(bytes);
    }
  }
  fs::remove(fs::temp_directory_path() / ("hdr-fuzz-last-" + std::to_string(getpid())));
  std::printf("%zu inputs, %ld runs\n", inputs.size(), runs);
  return inputs.empty() ? 1 : 0;
}

}  // namespace
}  // namespace hdr::fuzz

int main(int argc, char** argv) {
  return hdr::fuzz::main(argc, argv);
}
