// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/readers/inp_deck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/csv_reader.hpp"

namespace couplet::mesh {
namespace {

namespace fs = std::filesystem;

// 4 GB hold 50 million nodes, more than fits one machine.
constexpr csv::Limits limits{.bytes = std::uint64_t(4) << 30, .lines = 200000000};
constexpr std::size_t most_deep = 8, most_files = 1000, longest_keyword = 1 << 14;

}  // namespace

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::int64_t identifier_of(std::string_view text) {
  const auto number = csv::integer_of(text);
  return number && *number > 0 ? *number : 0;
}

const std::string* InpKeyword::find(std::string_view name) const {
  const auto found = std::ranges::find(parameters, name, &std::pair<std::string, std::string>::first);
  return found == parameters.end() ? nullptr : &found->second;
}

InpLines::InpLines(const fs::path& file)
    : folder_(fs::weakly_canonical(fs::absolute(file).parent_path())), name_(file.string()) {
  open(file);
}

void InpLines::open(const fs::path& file) {
  files_.push_back(std::make_unique<csv::LineReader>(file, "mesh file", limits));
  number_.push_back(opened_.size());
  opened_.push_back(file.string());
}

void InpLines::include(const std::string& name) {
  if (name.empty()) fail("INPUT=... names no file to include.");
  if (files_.size() >= most_deep || opened_.size() >= most_files)
    fail(fmt::format("*INCLUDE is nested deeper than {} files, or there are more than {} of them.", most_deep,
                     most_files));
  const fs::path file = fs::weakly_canonical(folder_ / name);
  const fs::path below = file.lexically_relative(folder_);
  if (below.empty() || *below.begin() == "..")
    fail(
        fmt::format("*INCLUDE '{}' is outside the folder of the mesh '{}'. Move it there, or insert its "
                    "content into the file.",
                    name, folder_.string()));
  if (!fs::is_regular_file(file))
    fail(fmt::format("*INCLUDE: {}'{}' {}.", fs::exists(file) ? "" : "the file ", file.string(),
                     fs::is_directory(file) ? "is a folder; name the file in it"
                     : fs::exists(file)     ? "is not a regular file"
                                            : "does not exist"));
  open(file);
}

bool InpLines::next() {
  while (!files_.empty()) {
    if (!files_.back()->next(line_)) {
      line_ = {};
      if (files_.size() == 1) return false;  // its name and number are kept for messages
      files_.pop_back();
      number_.pop_back();
      continue;
    }
    line_ = base::trim(line_);
    // A single star is a comment in CalculiX.
    if (line_.empty() || line_ == "*" || line_.starts_with("**")) continue;
    if (!is_keyword() || upper(base::trim(line_.substr(1, line_.find(',') - 1))) != "INCLUDE") return true;
    const std::string* name = keyword().find("INPUT");
    include(name ? *name : "");
  }
  return false;
}

void InpLines::fail(const std::string& what) const { throw Error("{}: {}", place(), what); }

void InpLines::fail_at(std::uint64_t mark, const std::string& what) const {
  throw Error("{}: {}", place_of(mark), what);
}

std::uint64_t InpLines::mark() const {
  return std::uint64_t(number_.back()) << 40 | std::uint64_t(files_.back()->number());
}

std::string InpLines::place_of(std::uint64_t mark) const {
  return fmt::format("{}:{}", opened_[mark >> 40], mark & ((std::uint64_t(1) << 40) - 1));
}

InpKeyword InpLines::keyword() {
  std::string text(line_.substr(1));
  while (text.ends_with(',')) {
    if (text.size() > longest_keyword || !next() || is_keyword())
      fail("this keyword line ends with a comma, but does not continue.");
    text += line_;
  }
  InpKeyword result;
  if (!csv::split_cells(text, ',', cells_)) fail("unclosed quotation mark.");
  for (const std::string_view cell : cells_) {
    if (result.word.empty()) {
      // "SOLID  SECTION" equals "SOLID SECTION".
      for (const std::string& part : base::split(upper(cell), ' '))
        if (!part.empty()) result.word += (result.word.empty() ? "" : " ") + part;
      if (result.word.empty()) fail("'*' without a keyword.");
      continue;
    }
    const std::size_t equals = cell.find('=');
    std::string_view value = equals == std::string_view::npos ? "" : base::trim(cell.substr(equals + 1));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
      value = value.substr(1, value.size() - 2);
    if (!cell.empty()) result.parameters.emplace_back(upper(base::trim(cell.substr(0, equals))), value);
  }
  return result;
}

void InpLines::identifiers(std::size_t n, std::vector<std::int64_t>& numbers) {
  numbers.clear();
  while (true) {
    csv::split_cells(line_, ',', cells_);
    for (const std::string_view cell : cells_) {
      if (cell.empty()) continue;
      numbers.push_back(identifier_of(cell));
      if (numbers.back() == 0)
        fail(fmt::format("'{}' is not a valid node or element number (whole, above 0, below 2^31).",
                         cell.substr(0, 60)));
    }
    if (numbers.size() >= n) return;
    if (!next() || is_keyword())
      fail(fmt::format("expected {} whole numbers here, found {}.", n, numbers.size()));
  }
}

}  // namespace couplet::mesh
