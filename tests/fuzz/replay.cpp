// Runs a target on its seeds and on some mutations of them, the same in every run; or writes the seeds to
// files.
//
// usage: replay_NAME [MUTATIONS]       default 2000
//        replay_NAME --write FOLDER
//        replay_NAME FILE...           what libFuzzer found
#include "target.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

namespace {

using Random = std::mt19937_64;

// Bytes that mean something at the edges of ranges, and in texts.
constexpr std::array<unsigned char, 16> telling{0,   1,   2,   0x7f, 0x80, 0xff, 0xfe, '\n',
                                                ' ', ',', ';', '-',  '.',  'e',  '0',  '9'};

std::string mutated(const std::string &seed, Random &random) {
  std::string text = seed;
  const auto below = [&](std::size_t limit) { return static_cast<std::size_t>(random() % limit); };
  for (std::size_t change = 0, changes = 1 + below(4); change < changes; ++change) {
    const std::size_t at = below(text.size() + 1);
    const auto byte = static_cast<char>(below(2) == 0 ? telling[below(telling.size())] : below(256));
    switch (below(5)) {
    case 0:
      text.insert(at, 1, byte);
      break;
    case 1:
      text.erase(at, 1 + below(4));
      break;
    case 2:
      text.resize(at);
      break;
    case 3: // the same piece again
      text.insert(at, text.substr(below(text.size() + 1), below(32)));
      break;
    default:
      for (std::size_t i = at, end = at + 1 + below(8); i < end && i < text.size(); ++i)
        text[i] = byte;
    }
  }
  return text;
}

void run(const std::string &text) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t *>(text.data()), text.size());
}

void write(const std::vector<std::string> &seeds, const std::filesystem::path &folder) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < seeds.size(); ++i)
    std::ofstream(folder / ("seed-" + std::to_string(i)), std::ios::binary) << seeds[i];
}

} // namespace

int main(int argc, char **argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const std::vector<std::string> seeds = dovetail::fuzz::seeds();
  if (words.size() == 2 && words[0] == "--write") {
    write(seeds, words[1]);
    return 0;
  }
  char *end = nullptr;
  const long mutations = words.empty() ? 2000 : std::strtol(words[0].c_str(), &end, 10);
  if (end != nullptr && *end != '\0') {
    for (const std::string &path : words) {
      std::ifstream file(path, std::ios::binary);
      run({std::istreambuf_iterator<char>(file), {}});
    }
    return 0;
  }
  for (const std::string &seed : seeds)
    run(seed);
  Random random(1);
  for (long i = 0; i < mutations; ++i)
    run(mutated(seeds[static_cast<std::size_t>(i) % seeds.size()], random));
  std::printf("%zu seeds and %ld mutations of them\n", seeds.size(), mutations);
}
