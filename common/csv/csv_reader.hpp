// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct z_stream_s;

namespace couplet::csv {

/// Limits on a text file. The defaults allow ten million numbers and keep a reader far below 1 GB.
struct Limits {
  std::uint64_t bytes = std::uint64_t(64) << 20;  ///< of text, decompressed
  std::size_t line = std::size_t(64) << 10;       ///< bytes in a line
  std::size_t lines = 2000000;
  double expansion = 100;  ///< bytes of text per byte of gzip, beyond the first megabyte
  bool text_only = true;   ///< rejects zeros and control characters
};

/// Bytes of a regular file, decompressed if its first bytes are those of gzip. Never reads or holds more than
/// `limits` allow. Throws Error with the file's name and what to do; `kind` describes the file.
class ByteSource final {
 public:
  ByteSource(const std::filesystem::path& file, std::string kind, const Limits& limits);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Fills the front of `into` and returns the number of bytes, 0 at the end.
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
  std::size_t at_ = 0, end_ = 0;  // unused range of input_
  std::uint64_t taken_ = 0, given_ = 0;
  std::unique_ptr<z_stream_s, void (*)(z_stream_s*)> gzip_;  // nullptr for plain text
  bool member_ended_ = false;
};

/// Reads a text file, plain or gzip, line by line. All text data enter the programs here. Drops a UTF-8 byte
/// order mark and CR before LF. Throws Error with file and line for zeros, control characters, and lines and
/// files beyond the limits.
class LineReader final {
 public:
  /// `kind` describes the file in messages: "weather file".
  LineReader(const std::filesystem::path& file, const std::string& kind, const Limits& limits = {});

  /// Reads the next line, valid until the next call. Returns false at the end.
  bool next(std::string_view& line);
  std::size_t number() const { return number_; }  ///< of that line, from 1
  bool has_end() const { return has_end_; }       ///< false if the last line is truncated or has no line end
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

/// All lines of a file, without empty ones at its end.
std::vector<std::string> read_lines(const std::filesystem::path& file, const std::string& kind,
                                    const Limits& limits = {});

/// Separator of cells: ',', ';', a tab, or ' ' for any number of blanks and tabs.
using Separator = char;

/// Separator of a line: the first ';', ',' or tab outside quotes, else blanks.
Separator separator_of(std::string_view line);

/// Splits a line into cells without surrounding blanks and double quotes, as views into `line`. Separators
/// within double quotes are ignored. Returns false if a quote is not closed.
bool split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells);
/// Splits a line into texts, tolerating unbalanced quotes of foreign files.
std::vector<std::string> fields(std::string_view line, Separator separator = ',');

/// Returns the line up to the '#' of a comment.
std::string_view without_comment(std::string_view line);

/// Converts a text such as 1, -0.5 or 2e3. Returns nothing unless all of it is one finite number.
std::optional<double> number_of(std::string_view text);
/// Converts a whole number likewise.
std::optional<int> integer_of(std::string_view text);

/// Explains why a text is not a number: "'0,5' has a decimal comma; write 0.5".
std::string why_no_number(std::string_view text);

/// Column heading such as "time [ms]". The unit is empty without brackets.
struct Heading {
  std::string name, unit;
};
Heading heading_of(std::string_view cell);

/// Reads a table row by row. Cells are separated by commas, semicolons, tabs or blanks throughout the file.
/// '#' begins a comment. The first line may name the columns. Throws Error with file, line and advice for
/// ragged rows, decimal commas, ambiguous separators and cells that are not finite numbers.
class CsvReader final {
 public:
  /// Opens the file and reads up to the names or the first row.
  CsvReader(const std::filesystem::path& file, const std::string& kind, const Limits& limits = {});

  /// Cells of the first line. Empty if it holds numbers.
  const std::vector<std::string>& names() const { return names_; }
  std::string place_of_names() const;

  /// Reads the next row. Returns false at the end.
  bool next();
  const std::vector<std::string_view>& cells() const { return cells_; }
  /// Number in a cell of the row. `what` names it in messages: "the wind".
  double number(std::size_t column, std::string_view what = "") const;
  std::string place() const { return lines_.place(); }
  int line() const { return int(lines_.number()); }

 private:
  bool next_line();
  void take_names();
  void check_width() const;
  void refuse_ambiguous() const;

  LineReader lines_;
  std::vector<std::string> names_;
  std::vector<std::string_view> cells_;
  Separator separator_ = ',';
  std::size_t width_ = 0;
  int line_of_names_ = 0, first_line_ = 0;
  bool row_waits_ = false, has_points_ = false;
};

}  // namespace couplet::csv
