// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/csv/byte_source.hpp"

namespace couplet::csv {

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
