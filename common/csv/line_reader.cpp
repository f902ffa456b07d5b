// SPDX-License-Identifier: Apache-2.0
#include "common/csv/csv_reader.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet::csv {

namespace {

constexpr std::size_t compressed_chunk = 1 << 16;
constexpr std::uint64_t always_allowed = 1 << 20;
constexpr int gzip_format = 16;  // added to zlib's window bits

void end_and_delete(z_stream* stream) {
  inflateEnd(stream);
  delete stream;
}

bool begins_gzip(const char* bytes, std::size_t n) {
  return n >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
}

}  // namespace

ByteSource::ByteSource(const std::filesystem::path& file, std::string kind, const Limits& limits)
    : name_(file.string()),
      kind_(std::move(kind)),
      limits_(limits),
      input_(compressed_chunk),
      gzip_(nullptr, end_and_delete) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status))
    throw Error("{}: this {} does not exist. Relative paths start at the folder of the YAML file.", name_,
                kind_);
  // A pipe would wait forever for a writer, and a device would never end.
  if (!std::filesystem::is_regular_file(status))
    throw Error("{}: this {} is not a regular file, but a folder, pipe or device.", name_, kind_);
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (!code && size > limits_.bytes)
    throw Error("{}: this {} has {} MB; at most {} MB are read. Reduce its rows or columns.", name_, kind_,
                size >> 20, limits_.bytes >> 20);
  stream_.open(file, std::ios::binary);
  if (!stream_) throw Error("{}: this {} cannot be read. Check its permissions.", name_, kind_);
  fill();
  if (!begins_gzip(input_.data(), end_)) return;
  auto stream = std::make_unique<z_stream>();
  if (inflateInit2(stream.get(), MAX_WBITS + gzip_format) != Z_OK)
    throw Error("{}: not enough memory to decompress this {}.", name_, kind_);
  gzip_.reset(stream.release());
}

ByteSource::~ByteSource() = default;

bool ByteSource::fill() {
  if (at_ < end_) return true;
  stream_.read(input_.data(), std::streamsize(input_.size()));
  if (stream_.bad()) throw Error("{}: this {} cannot be read to the end.", name_, kind_);
  at_ = 0;
  end_ = std::size_t(stream_.gcount());
  return end_ > 0;
}

void ByteSource::refuse_damage(const char* what) const {
  throw Error("{}: this {} is damaged or truncated: decompression failed ({}). Copy or compress it again.",
              name_, kind_, what);
}

void ByteSource::check_size() const {
  if (given_ > limits_.bytes)
    throw Error("{}: this {} has more than {} MB{}; no more are read. Reduce its rows or columns.", name_,
                kind_, limits_.bytes >> 20, gzip_ ? " when decompressed" : "");
  if (gzip_ && given_ > always_allowed && double(given_) > limits_.expansion * double(taken_))
    throw Error(
        "{}: this {} expands to more than {:g} times its size, which is not plausible for measured data (a "
        "gzip bomb?). If you trust it, decompress it yourself and name the plain file.",
        name_, kind_, limits_.expansion);
}

/// Continues with the next member. Gzip files may have several, whose texts are concatenated.
void ByteSource::next_member() {
  std::array<char, 2> head{};
  for (char& c : head) {
    if (!fill()) refuse_damage("its last bytes are not part of any member");
    c = input_[at_++];
  }
  if (!begins_gzip(head.data(), head.size()))
    refuse_damage("the compressed data are followed by other bytes");
  if (inflateReset(gzip_.get()) != Z_OK) refuse_damage("zlib's state");
  std::array<unsigned char, 2> copy{static_cast<unsigned char>(head[0]), static_cast<unsigned char>(head[1])};
  unsigned char nothing = 0;
  gzip_->next_in = copy.data();
  gzip_->avail_in = uInt(copy.size());
  gzip_->next_out = &nothing;
  gzip_->avail_out = 1;
  if (inflate(gzip_.get(), Z_NO_FLUSH) != Z_OK) refuse_damage("the header of a member");
  taken_ += head.size();
  member_ended_ = false;
}

std::size_t ByteSource::inflate_into(std::span<char> into) {
  while (true) {
    if (member_ended_) {
      if (!fill()) return 0;
      next_member();
    }
    if (!fill()) refuse_damage("its end is missing");
    gzip_->next_in = reinterpret_cast<Bytef*>(input_.data() + at_);
    gzip_->avail_in = uInt(end_ - at_);
    gzip_->next_out = reinterpret_cast<Bytef*>(into.data());
    gzip_->avail_out = uInt(into.size());
    const int result = inflate(gzip_.get(), Z_NO_FLUSH);
    taken_ += (end_ - at_) - gzip_->avail_in;
    at_ = end_ - gzip_->avail_in;
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
      refuse_damage(gzip_->msg ? gzip_->msg : "invalid data");
    member_ended_ = result == Z_STREAM_END;
    if (const std::size_t got = into.size() - gzip_->avail_out; got > 0) return got;
  }
}

std::size_t ByteSource::read(std::span<char> into) {
  std::size_t got = 0;
  if (gzip_) {
    got = inflate_into(into);
  } else if (fill()) {
    got = std::min(into.size(), end_ - at_);
    std::copy_n(input_.data() + at_, got, into.data());
    at_ += got;
    taken_ += got;
  }
  given_ += got;
  check_size();
  return got;
}

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
