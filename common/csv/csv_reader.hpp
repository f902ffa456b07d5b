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

/// Between cells: ',', ';', a tab, or ' ' for any number of blanks and tabs.
using Separator = char;

/// The separator of a line: the first of ';', ',' and tab that it holds outside quotes, else blanks.
Separator separator_of(std::string_view line);

/// The cells of a line, without blanks and double quotes around them; they point into `line`. What stands within double
/// quotes does not separate. False: a quote is not closed.
bool split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells);
/// As texts, where foreign files have quotes that close nothing.
std::vector<std::string> fields(std::string_view line, Separator separator = ',');

/// The line before the '#' of a comment.
std::string_view without_comment(std::string_view line);

/// Empty unless the whole text is one finite number as 1, -0.5 or 2e3.
std::optional<double> number_of(std::string_view text);
/// Whole numbers likewise.
std::optional<int> integer_of(std::string_view text);

/// Why a text that should be a number is none: "'0,5' has a decimal comma; write 0.5".
std::string why_no_number(std::string_view text);

/// "time [ms]": its name and its unit, which is empty without brackets.
struct Heading {
  std::string name, unit;
};
Heading heading_of(std::string_view cell);

/// Row by row through a table: cells separated by one of comma, semicolon, tab or blanks, the same in the whole file and as many
/// in each row; '#' begins a comment; the first line may name the columns. Throws Error with file and line, and with what to
/// do, for ragged rows, decimal commas, separators that could be meant otherwise, and cells that are no finite numbers.
class CsvReader final {
 public:
  /// Reads up to the names or the first row.
  CsvReader(const std::filesystem::path& file, const std::string& kind, const Limits& limits = {});

  /// Cells of the first line; empty where it holds numbers.
  const std::vector<std::string>& names() const { return names_; }
  std::string place_of_names() const;

  /// The next row. False at the end.
  bool next();
  const std::vector<std::string_view>& cells() const { return cells_; }
  /// The number in a cell of the row. `what` names it in messages: "the wind".
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
