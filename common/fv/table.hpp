// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::fv {

/// A piecewise linear function of one variable.
class Table final {
 public:
  enum class Outside {
    clamp,  ///< the first and last values hold beyond the ends
    error,  ///< a value outside the ends is an Error
  };
  /// `at` must grow. `where` names the table in messages. Throws Error.
  Table(std::vector<double> at, std::vector<double> values, Outside outside, std::string where);

  double operator()(double at) const;
  /// Integral from `from` to `to`, exact for the piecewise linear function (clamped ends go on as constants).
  double integral(double from, double to) const;
  /// Integral from the first place to `at`, never an Error.
  double antiderivative(double at) const;
  const std::vector<double>& at() const { return at_; }
  const std::vector<double>& values() const { return values_; }
  /// What the header of its file says of its columns' units; empty: nothing. The numbers are as in the file.
  struct Units {
    std::string axis, value;
  };
  const Units& units() const { return units_; }
  const std::string& where() const { return where_; }

 private:
  friend Table read_table(const std::filesystem::path& file, const std::string& column, Outside outside);
  void check_inside(double at) const;
  double inside(double at) const;

  std::vector<double> at_, values_, integral_;  // integral_: from at_.front() to each entry
  Outside outside_;
  std::string where_;
  Units units_;
};

/// A table from a CSV file (common/csv), plain or gzip; the first line may hold names. The first column is the
/// axis, which grows; `column`: name (with or without "[unit]") or number
/// (from 1) of the values.
/// Throws Error with file:line.
Table read_table(const std::filesystem::path& file, const std::string& column, Table::Outside outside);

/// What is wrong at a place of an expression.
struct TextProblem {
  std::size_t at = 0;  ///< position in the text, from 0
  std::string what;
  bool is_sentence = false;  ///< says all by itself: the table, not the text, is wrong
};

/// Finds the calls table(variable, [clamp|error,] x0, y0, x1, y1, ...) and table(variable, [clamp|error,]
/// "file.csv"[, column]) and puts tabNN(variable) in their place, padded with blanks so that positions stay.
/// Table number NN is appended to `tables`. Throws TextProblem; also where a file's header names a unit other than
/// that of the variable or of the value that it stands for.
std::string take_tables(const std::string& text, std::deque<Table>& tables);

/// A material property: a number, or a table of the temperature T: "table(T, 300, 210e9, 600, 180e9)".
class Property final {
 public:
  Property(double constant = 0) : constant_(constant) {}  // NOLINT: a number is a property
  /// Throws Error naming `where`.
  Property(const config::ExpressionText& text, const std::string& where);

  bool is_constant() const { return table_.empty(); }
  double operator()(double temperature) const { return is_constant() ? constant_ : table_[0](temperature); }
  double integral(double from, double to) const {
    return is_constant() ? constant_ * (to - from) : table_[0].integral(from, to);
  }
  /// An integral from some fixed temperature on: differences of it are what counts.
  double antiderivative(double temperature) const {
    return is_constant() ? constant_ * temperature : table_[0].antiderivative(temperature);
  }
  /// Smallest and largest value it can take.
  double lowest() const;
  double highest() const;

 private:
  double constant_ = 0;
  std::vector<Table> table_;  // none: constant
};

/// What is wrong with the text of a property that must stay above `above`; empty: nothing.
std::string problem_of_property(const config::ExpressionText& text, double above);

}  // namespace couplet::fv
