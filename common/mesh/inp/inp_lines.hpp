// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/csv/line_reader.hpp"

namespace couplet::mesh {

std::string upper(std::string_view text);

/// "*ELEMENT, TYPE=C3D8, ELSET=beam": word and parameters, both in capitals without blanks at their ends; values as they stand.
struct InpKeyword {
  std::string word;
  std::vector<std::pair<std::string, std::string>>
      parameters;  ///< a parameter without "=" has an empty value
  /// Null: not given.
  const std::string* find(std::string_view name) const;
};

/// The lines of an input deck of CalculiX or Abaqus, those of included files in their place. Comments ("**") and empty lines are
/// passed over.
class InpLines final {
 public:
  explicit InpLines(const std::filesystem::path& file);

  /// The next line that counts, which stays until the next call. False at the end. Throws Error.
  bool next();
  bool is_keyword() const { return line_.starts_with('*'); }
  std::string_view text() const { return line_; }
  /// The present line, with those that go on from it: its last character is a comma. Throws Error.
  InpKeyword keyword();
  /// The numbers of the present line and, while there are fewer than `n`, of those that follow it. Throws Error for what is no
  /// whole number above 0.
  void identifiers(std::size_t n, std::vector<std::int64_t>& numbers);
  /// Goes into this file, below the folder of the first. Throws Error.
  void include(const std::string& name);
  [[noreturn]] void fail(const std::string& what) const;
  /// Of the deck.
  const std::string& name() const { return name_; }
  /// "folder/file.inp:12"
  std::string place() const { return files_.empty() ? name_ : files_.back()->place(); }
  /// For place_of() later on.
  std::uint64_t mark() const;
  std::string place_of(std::uint64_t mark) const;

 private:
  void open(const std::filesystem::path& file);

  std::filesystem::path folder_;
  std::string name_;
  std::vector<std::unique_ptr<csv::LineReader>> files_;  // the included one last
  std::vector<std::string> opened_;                      // all names
  std::vector<std::size_t> number_;                      // into opened_, as files_
  std::string_view line_;
  std::vector<std::string_view> cells_;
};

/// A whole number above 0, as nodes and elements have them; 0: none.
std::int64_t identifier_of(std::string_view text);

}  // namespace couplet::mesh
