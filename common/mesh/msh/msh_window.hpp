// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace couplet::mesh {

/// A .msh file of version 4.1 read through a window of a few megabytes, however long it is. What does not fit the format
/// throws Error without a line: MshCursor, which holds the whole file, tells where.
class MshWindow {
 public:
  explicit MshWindow(const std::filesystem::path& file);

  bool binary = false;

  std::uint64_t place() const { return start_ + at_; }
  void go_to(std::uint64_t place);
  bool at_end() { return at_ == window_.size() && !refill(1); }
  /// Up to the end of the line, without spaces at its ends.
  std::string line();
  std::string_view word();
  /// Numbers: bytes or words, as the file is.
  int integer() { return binary ? raw<int>() : static_cast<int>(text_integer()); }
  std::uint64_t size() { return binary ? raw<std::uint64_t>() : static_cast<std::uint64_t>(text_integer()); }
  double real();
  std::int64_t text_integer();
  double text_real();
  /// Numbers of eight bytes, not looked at.
  void skip(std::uint64_t numbers);
  template <class T>
  T raw() {
    if (window_.size() - at_ < sizeof(T) && !refill(sizeof(T))) fail();
    T value;
    std::memcpy(&value, window_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  [[noreturn]] void fail() const;

 private:
  bool refill(std::size_t wanted);

  std::filesystem::path file_;
  std::ifstream in_;
  std::vector<char> window_;
  std::uint64_t start_ = 0;  // of the window in the file
  std::size_t at_ = 0;
};

}  // namespace couplet::mesh
