// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct z_stream_s;

namespace couplet::csv {

/// What a text file may be. The defaults hold ten million numbers and keep a reader far below 1 GB.
struct Limits {
  std::uint64_t bytes = std::uint64_t(64) << 20;  ///< of text, decompressed
  std::size_t line = std::size_t(64) << 10;       ///< bytes in a line
  std::size_t lines = 2000000;
  double expansion = 100;  ///< bytes of text per byte of gzip, beyond the first megabyte
  bool text_only = true;   ///< zeros and control characters are refused
};

/// The bytes of a regular file, decompressed where it is gzip (by its first bytes, whatever its name). Never reads or holds more
/// than `limits` allow. Throws Error with the file's name and what to do; `kind` says in it what the file is.
class ByteSource final {
 public:
  ByteSource(const std::filesystem::path& file, std::string kind, const Limits& limits);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Fills the front of `into` and returns how much; 0 at the end.
  std::size_t read(std::span<char> into);

 private:
  bool fill();
  std::size_t inflate_into(std::span<char> into);
  void check_size() const;
  void next_member();
  [[noreturn]] void refuse_damage(const char* what) const;

  std::string name_, kind_;
  Limits limits_;
  std::ifstream stream_;
  std::vector<char> input_;
  std::size_t at_ = 0, end_ = 0;  // what of input_ is not used yet
  std::uint64_t taken_ = 0, given_ = 0;
  std::unique_ptr<z_stream_s, void (*)(z_stream_s*)> gzip_;  // none: plain text
  bool member_ended_ = false;
};

/// Line by line through a text file, plain or gzip: the only way in which text data come into a program. A mark of UTF-8 at
/// the start and CR before LF are dropped. Throws Error with file and line for what is no text (zeros, control characters), for
/// lines and files beyond the limits.
class LineReader final {
 public:
  /// `kind` in messages: "weather file".
  LineReader(const std::filesystem::path& file, const std::string& kind, const Limits& limits = {});

  /// The next line, which stays until the next call. False at the end.
  bool next(std::string_view& line);
  std::size_t number() const { return number_; }  ///< of that line, from 1
  bool has_end() const { return has_end_; }       ///< false for a last line that was cut or has no line end
  std::string place() const;                      ///< "folder/file.csv:12"
  const std::string& name() const { return name_; }
  const std::string& kind() const { return kind_; }

 private:
  void check(std::string_view line) const;

  std::string name_, kind_;
  Limits limits_;
  ByteSource source_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  std::size_t number_ = 0;
  bool has_end_ = true;
};

/// All lines of a file, without the empty ones at its end.
std::vector<std::string> read_lines(const std::filesystem::path& file, const std::string& kind,
                                    const Limits& limits = {});

}  // namespace couplet::csv
