// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/section.hpp"
#include "common/fv/use.hpp"

namespace couplet::fv {

/// Piecewise linear function of one variable.
class Table final {
 public:
  enum class Outside {
    clamp,  ///< extrapolates the first and last values as constants
    error,  ///< throws Error for a value outside the ends
  };
  /// `at` must increase. `where` names the table in messages. With a `period` above 0, the values repeat; a table shorter than its
  /// period is linear from its last value to its first one. Throws Error, also if a repeated table is longer than its period or
  /// jumps at its end.
  Table(std::vector<double> at, std::vector<double> values, Outside outside, std::string where,
        double period = 0);

  double operator()(double at) const;
  /// Integral from `from` to `to`, exact for the piecewise linear function with constant extrapolation.
  double integral(double from, double to) const;
  /// Integral from the first position to `at`; never throws.
  double antiderivative(double at) const;
  bool repeats() const { return period_ > 0; }
  const std::vector<double>& at() const { return at_; }
  const std::vector<double>& values() const { return values_; }
  /// Units in the header of the file, or empty. The numbers are as in the file.
  struct Units {
    std::string axis, value;
  };
  const Units& units() const { return units_; }
  const std::string& where() const { return where_; }

 private:
  friend Table read_table(const std::filesystem::path& file, const std::string& column, Outside outside,
                          double period);
  void close(const std::string& place);
  void check_inside(double at) const;
  double periods_before(double at) const;
  double inside(double at) const;

  std::vector<double> at_, values_, integral_;  // integral_: from at_.front() to each entry
  Outside outside_;
  double period_;  // 0 if the values do not repeat
  std::string where_;
  Units units_;
};

/// Reads a table from a CSV file (common/csv), plain or gzip, optionally with column names. The first column
/// is the increasing axis. `column` is the name (with or without "[unit]") or number (from 1) of the values.
/// Throws Error with file:line.
Table read_table(const std::filesystem::path& file, const std::string& column, Table::Outside outside,
                 double period = 0);

/// Problem at a position of an expression.
struct TextProblem {
  std::size_t at = 0;  ///< position in the text, from 0
  std::string what;
  bool is_sentence = false;  ///< the message is complete, because the table is wrong and not the text
};

/// Plain numbers in a text, such as the ends of a pulse in "t > 0.1021 && t < 0.1023". As factors, those that
/// divide are inverted.
std::vector<double> numbers_in(std::string_view text, bool as_factors = false);

/// Replaces the calls table(variable, [clamp|error|repeat P,] x0, y0, x1, y1, ...) and table(variable, [clamp|error|repeat P,]
/// "file.csv"[, column]), where P is a period in the unit of the variable, by tabNN(variable), padded with blanks to keep positions. Appends table number NN to
/// `tables`. Throws TextProblem, also if the unit in a file's header is not read: values are in the unit of the
/// key, or scaled in the text.
std::string take_tables(const std::string& text, std::deque<Table>& tables, std::string_view unit);

/// Material property: a number, or a table of the temperature T: "table(T, 300, 210e9, 600, 180e9)". Another law may be a table of
/// another variable.
class Property final {
 public:
  Property(double constant = 0) : constant_(constant) {}  // NOLINT: a number is a property
  /// Throws Error with `where`, also for values outside the range of the key.
  Property(const config::ExpressionText& text, const std::string& where, std::string_view variable = "T");

  bool is_constant() const { return table_.empty(); }
  double operator()(double temperature) const {
    if (is_constant()) return constant_;
    use_->note(temperature);
    return table_[0](temperature);
  }
  double integral(double from, double to) const {
    if (is_constant()) return constant_ * (to - from);
    use_->note(from);
    use_->note(to);
    return table_[0].integral(from, to);
  }
  /// The table, or nullptr of a constant. Reading it does not count as use.
  const Table* table() const { return is_constant() ? nullptr : table_.data(); }
  /// Integral from an arbitrary fixed temperature; only differences are meaningful.
  double antiderivative(double temperature) const {
    return is_constant() ? constant_ * temperature : table_[0].antiderivative(temperature);
  }

 private:
  double constant_ = 0;
  std::vector<Table> table_;  // empty if constant
  Use* use_ = nullptr;        // of the table in this run
};

/// Problem of the text of a property, such as a value outside the range of its key. Empty if it is valid.
std::string problem_of_property(const config::ExpressionText& text, std::string_view variable = "T");

}  // namespace couplet::fv
