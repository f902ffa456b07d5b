// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/mutate.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/base/text.hpp"

namespace couplet::fuzz {
namespace {

std::uint64_t number_of(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

}  // namespace

std::size_t count() { return number_of("COUPLET_FUZZ_COUNT", 100); }
std::uint64_t longest() { return number_of("COUPLET_FUZZ_SECONDS", 5); }
std::uint64_t seed() { return number_of("COUPLET_FUZZ_SEED", 1); }

std::string read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write_file(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

std::string mutate_bytes(std::string text, Dice& dice) {
  static constexpr char bytes[] = "\0\n\r\t \"'[]{}()#&*!|>%@`:,-+.eE0129\x7f\xff\xc3";
  static const std::string odd(bytes, sizeof bytes - 1);  // with the zero that it begins with
  for (std::size_t n = 1 + dice.below(4); n > 0 && !text.empty(); --n) {
    const std::size_t at = dice.below(text.size()),
                      length = 1 + dice.below(std::min<std::size_t>(40, text.size() - at));
    switch (dice.below(6)) {
      case 0:
        text[at] = char(text[at] ^ (1 << dice.below(8)));
        break;
      case 1:
        text[at] = odd[dice.below(odd.size())];
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(dice.below(text.size()), length));
        break;
      case 4:
        text.insert(at, 1, odd[dice.below(odd.size())]);
        break;
      default:
        if (dice.one_in(4)) text.resize(at);
    }
  }
  return text;
}

std::string mutate_lines(const std::string& text, const std::vector<std::string>& values, Dice& dice) {
  std::vector<std::string> lines = base::split(text, '\n');
  for (std::size_t n = 1 + dice.below(3); n > 0 && !lines.empty(); --n) {
    const std::size_t at = dice.below(lines.size());
    std::string& line = lines[at];
    switch (dice.below(8)) {
      case 0:
        lines.erase(lines.begin() + std::ptrdiff_t(at));
        break;
      case 1:
        lines.insert(lines.begin() + std::ptrdiff_t(at), std::string(line));
        break;
      case 2:
        std::swap(line, lines[dice.below(lines.size())]);
        break;
      case 3:
        line.insert(0, 1 + dice.below(4), ' ');
        break;
      default: {
        // "key: value", also in the middle of {a: b, c: d}.
        std::vector<std::size_t> colons;
        for (std::size_t i = line.find(": "); i != std::string::npos; i = line.find(": ", i + 1))
          colons.push_back(i);
        if (colons.empty()) break;
        const std::size_t colon = dice.of(colons),
                          end = std::min(line.find_first_of(",}", colon), line.size());
        line.replace(colon + 2, end - std::min(end, colon + 2), dice.of(values));
      }
    }
  }
  return base::join(lines, "\n");
}

double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024;
  return 0;
}

}  // namespace couplet::fuzz
