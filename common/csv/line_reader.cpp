// SPDX-License-Identifier: Apache-2.0
#include "common/csv/line_reader.hpp"

#include <algorithm>
#include <cstring>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet::csv {
namespace {

constexpr std::size_t read_ahead = 1 << 16;
constexpr std::string_view mark_of_utf8 = "\xEF\xBB\xBF";

bool is_control(char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }

}  // namespace

LineReader::LineReader(const std::filesystem::path& file, const std::string& kind, const Limits& limits)
    : name_(file.string()),
      kind_(kind),
      limits_(limits),
      source_(file, kind, limits),
      buffer_(limits.line + read_ahead) {}

std::string LineReader::place() const { return fmt::format("{}:{}", name_, number_); }

void LineReader::check(std::string_view line) const {
  if (line.size() > limits_.line)
    throw Error("{}: this line has more than {} bytes; is this a {}?", place(), limits_.line, kind_);
  if (!limits_.text_only) return;
  const auto bad = std::ranges::find_if(line, is_control);
  if (bad == line.end()) return;
  if (*bad == '\0')
    throw Error(
        "{}: this {} is not plain text: it contains zero bytes, as UTF-16 and binary files do. Save it as "
        "UTF-8.",
        place(), kind_);
  if (*bad == '\r')
    throw Error("{}: carriage return within this line. Save the {} with line ends LF or CR LF.", place(),
                kind_);
  throw Error("{}: this {} is not plain text: it contains the control character 0x{:02x}. Save it as text.",
              place(), kind_, static_cast<unsigned char>(*bad));
}

bool LineReader::next(std::string_view& line) {
  std::size_t searched = begin_;
  while (true) {
    const void* found =
        searched < end_ ? std::memchr(buffer_.data() + searched, '\n', end_ - searched) : nullptr;
    const std::size_t stop = found ? std::size_t(static_cast<const char*>(found) - buffer_.data()) : end_;
    has_end_ = found != nullptr;
    std::size_t got = 0;
    if (!found && stop - begin_ <= limits_.line) {
      std::copy(buffer_.begin() + std::ptrdiff_t(begin_), buffer_.begin() + std::ptrdiff_t(end_),
                buffer_.begin());
      end_ -= begin_;
      begin_ = 0;
      searched = end_;
      got = source_.read(std::span(buffer_).subspan(end_));
      end_ += got;
      if (got > 0) continue;
      if (end_ == 0) return false;
    }
    const std::size_t last = found ? stop : end_;
    line = std::string_view(buffer_.data() + begin_, last - begin_);
    begin_ = found ? stop + 1 : end_;
    if (++number_ > limits_.lines)
      throw Error("{}: this {} has more than {} lines; no more are read. Reduce its rows.", name_, kind_,
                  limits_.lines);
    if (number_ == 1 && line.starts_with(mark_of_utf8)) line.remove_prefix(mark_of_utf8.size());
    if (line.ends_with('\r')) line.remove_suffix(1);
    check(line);
    return true;
  }
}

std::vector<std::string> read_lines(const std::filesystem::path& file, const std::string& kind,
                                    const Limits& limits) {
  LineReader reader(file, kind, limits);
  std::vector<std::string> lines;
  for (std::string_view line; reader.next(line);) lines.emplace_back(line);
  while (!lines.empty() && base::trim(lines.back()).empty()) lines.pop_back();
  return lines;
}

}  // namespace couplet::csv
