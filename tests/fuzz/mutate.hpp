// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "tests/support/test.hpp"

namespace couplet::fuzz {

/// Random choices that are the same on every machine (the distributions of the standard library are not).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  /// From 0 to n - 1.
  std::size_t below(std::size_t n) { return n == 0 ? 0 : engine_() % n; }
  bool one_in(std::size_t n) { return below(n) == 0; }
  template <class T>
  const T& of(const std::vector<T>& things) {
    return things[below(things.size())];
  }

 private:
  std::mt19937_64 engine_;
};

/// Number of cases to try and first seed, from COUPLET_FUZZ_COUNT and COUPLET_FUZZ_SEED.
std::size_t count();
/// What one input may take [s]: COUPLET_FUZZ_SECONDS, else 5 (sanitizers take several times longer).
std::uint64_t longest();
std::uint64_t seed();

std::string read_file(const std::filesystem::path& file);
void write_file(const std::filesystem::path& file, const std::string& content);

/// Some bytes flipped, removed, doubled, put in or moved.
std::string mutate_bytes(std::string text, Dice& dice);
/// Some lines removed, doubled, swapped, indented, or their values replaced by one of `values`.
std::string mutate_lines(const std::string& text, const std::vector<std::string>& values, Dice& dice);

/// Most memory this process has had [MB].
double peak_memory();

}  // namespace couplet::fuzz
