// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/msh/msh_window.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::mesh {
namespace {

constexpr std::size_t window_bytes = 1 << 22;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

}  // namespace

MshWindow::MshWindow(const std::filesystem::path& file) : file_(file), in_(file, std::ios::binary) {
  if (!in_) throw Error("Cannot open the mesh file '{}'. Check the path and the permissions.", file.string());
}

void MshWindow::fail() const {
  throw Error("The mesh file '{}' does not hold what its format promises at byte {}.", file_.string(),
              place());
}

/// Keeps what is left; false if the file ends before so many bytes.
bool MshWindow::refill(std::size_t wanted) {
  window_.erase(window_.begin(), window_.begin() + std::ptrdiff_t(at_));
  start_ += at_;
  at_ = 0;
  const std::size_t left = window_.size();
  window_.resize(std::max(window_bytes, wanted));
  in_.read(window_.data() + left, std::streamsize(window_.size() - left));
  window_.resize(left + std::size_t(in_.gcount()));
  return window_.size() >= wanted;
}

void MshWindow::go_to(std::uint64_t place) {
  if (place >= start_ && place <= start_ + window_.size()) {
    at_ = std::size_t(place - start_);
    return;
  }
  in_.clear();
  in_.seekg(std::streamoff(place));
  if (!in_) fail();
  window_.clear();
  start_ = place;
  at_ = 0;
}

std::string MshWindow::line() {
  std::string text;
  while (!at_end()) {
    const char c = window_[at_++];
    if (c == '\n') break;
    text.push_back(c);
  }
  while (!text.empty() && is_blank(text.back())) text.pop_back();
  return {std::ranges::find_if_not(text, is_blank), text.end()};
}

std::string_view MshWindow::word() {
  while (!at_end() && is_blank(window_[at_])) ++at_;
  std::size_t end = at_;
  while (true) {
    while (end < window_.size() && !is_blank(window_[end])) ++end;
    if (end < window_.size()) break;
    const std::size_t length = end - at_;
    const bool more = refill(length + 1);  // moves the word to the front
    end = length;
    if (!more) break;
  }
  if (end == at_) fail();
  const std::string_view found(window_.data() + at_, end - at_);
  at_ = end;
  return found;
}

std::int64_t MshWindow::text_integer() {
  const std::string_view w = word();
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
  if (error != std::errc() || end != w.data() + w.size()) fail();
  return value;
}

double MshWindow::text_real() {
  const std::string_view w = word();
  double value = 0;
  const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
  if (error != std::errc() || end != w.data() + w.size()) fail();
  return value;
}

double MshWindow::real() {
  const double value = binary ? raw<double>() : text_real();
  if (!std::isfinite(value)) fail();
  return value;
}

void MshWindow::skip(std::uint64_t numbers) {
  if (!binary) {
    for (; numbers > 0; --numbers) word();
    return;
  }
  if (numbers > std::filesystem::file_size(file_) / 8) fail();
  go_to(place() + 8 * numbers);
}

}  // namespace couplet::mesh
