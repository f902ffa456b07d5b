// SPDX-License-Identifier: Apache-2.0
#include "common/fv/expression.hpp"

#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/fv/table.hpp"
#include "common/fv/use.hpp"

namespace couplet::fv {
namespace {

/// Table of an expression, and its use in the run; nullptr while the text is only checked.
struct TableInUse {
  const Table* table;
  Use* use = nullptr;
};

double value_in_table(void* data, double at) {
  const auto& [table, use] = *static_cast<const TableInUse*>(data);
  if (use && !table->repeats()) use->note(at);
  return (*table)(at);
}

/// Rejects what muParser reads in another way than a reader of the docs: a comma outside the arguments of a
/// function (1,5 is 5), an assignment, and comparisons in a row (0 < x < 1 compares 0 or 1 with 1).
void refuse_other_meanings(const std::string& text) {
  struct BracketLevel {
    bool takes_commas = false, compares = false;
  };
  std::vector<BracketLevel> levels(1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto is = [&](std::size_t at, std::string_view set) {
      return at < text.size() && set.find(text[at]) != std::string_view::npos;
    };
    const std::size_t before = i == 0 ? std::string::npos : text.find_last_not_of(' ', i - 1);
    if (text[i] == '(') {
      levels.push_back({before != std::string::npos &&
                        (std::isalnum(static_cast<unsigned char>(text[before])) || text[before] == '_')});
    } else if (text[i] == ')' && levels.size() > 1) {
      levels.pop_back();
    } else if (text[i] == ',' && !levels.back().takes_commas) {
      throw TextProblem{i, "a comma only separates the arguments of a function; write a decimal point"};
    } else if (is(i, ",?:") || (is(i, "&|") && is(i + 1, "&|"))) {
      levels.back().compares = false;
    } else if (is(i, "<>=!")) {
      const bool two = is(i + 1, "=");
      if (text[i] == '=' && !two)
        throw TextProblem{
            i,
            "'=' is not a comparison, and values cannot be assigned; write '==', or a range such as abs(y - 0.1) < 1e-6"};
      if (std::exchange(levels.back().compares, true))
        throw TextProblem{i, "comparisons cannot be chained; join them by '&&', as in '0 < x && x < 1'"};
      i += two;
    }
  }
}

}  // namespace

// muParser binds variables by address, so they are in one block with the parser that never moves.
struct Expression::ParserState {
  std::string text = "0", where;
  config::KeyFacts key;
  std::deque<Table> tables;
  std::deque<TableInUse> tables_in_use;
  mu::Parser parser;
  std::array<double, 4> xyzt{};
  bool uses_time = false, uses_space = false;
  double constant = 0;
  // In the run: null while the text is only checked.
  Use* use = nullptr;
  std::vector<double> instants;  // at which it may jump
  bool acts = false;             // it had a value other than 0 before Use::since, so that its place is known

  ParserState() = default;
  ParserState(const config::ExpressionText& source, std::string place)
      : text(source.text), where(std::move(place)), key(source.key) {
    static constexpr std::array<const char*, 4> names{"x", "y", "z", "t"};
    try {
      for (std::size_t i = 0; i < names.size(); ++i) parser.DefineVar(names[i], &xyzt[i]);
      parser.DefineConst("pi", std::numbers::pi);
      const std::string calls = take_tables(text, tables, key.unit);
      refuse_other_meanings(calls);
      parser.SetExpr(calls);
      for (std::size_t i = 0; i < tables.size(); ++i)
        parser.DefineFunUserData(fmt::format("tab{:02}", i), value_in_table,
                                 &tables_in_use.emplace_back(&tables[i]));
      const auto used = parser.GetUsedVar();
      uses_time = used.contains("t");
      uses_space = used.contains("x") || used.contains("y") || used.contains("z");
      for (const auto& [name, address] : used)
        if (!address) fail_unknown(name);
      constant = parser.Eval();
    } catch (const mu::Parser::exception_type& e) {
      fail(column_of(e), reason_of(e));
    } catch (const TextProblem& problem) {
      if (problem.is_sentence) throw Error("{}{}", where.empty() ? "" : where + ": ", problem.what);
      fail(problem.at + 1, problem.what);
    }
    if (!uses_time && !uses_space) require_possible(constant);
    if (where.empty() || !(uses_time || uses_space)) return;
    use = &uses()[where];
    use->given = fmt::format("'{}'", text);
    use->key = key;
    if (uses_time) instants = numbers_in(text);
    for (std::size_t i = 0; i < tables.size(); ++i) {
      Use& of_table = *(tables_in_use[i].use = &uses()[fmt::format("{}, table {}", where, i + 1)]);
      of_table.kind = Use::Kind::table;
      of_table.from = tables[i].at().front();
      of_table.to = tables[i].at().back();
    }
  }

  /// Looks for values between the latest time and `t` that no step sees: a pulse, or a period near the step. A value that
  /// turns around from each step to the next, by more than its largest, is not seen either. Both are looked for at the
  /// place of the largest value, and at all places until one is known.
  void search_between(const Vec3& x, double t) {
    const double last = std::isnan(use->last_time) ? 0 : use->last_time;  // a run starts at 0
    if (t > last) {
      use->earlier = std::exchange(use->since, last);
      use->last_time = t;
      acts = use->largest() > 0;
    } else if (acts || t < last || !(t > use->since)) {
      return;
    }
    const Vec3& place = acts ? use->place : x;
    const double before = use->since;
    // A look is no use of a table.
    std::vector<Use> noted;
    for (const auto& table : tables_in_use) noted.push_back(*table.use);
    const auto value_at = [&](double time) {
      xyzt = {place[0], place[1], place[2], time};
      return parser.Eval();
    };
    constexpr int n = 7;
    std::vector<double> times{before};
    for (int i = 1; i < n; ++i) times.push_back(before + (t - before) * (i + 0.3) / n);
    for (const double instant : instants)
      if (instant > before && instant < t) times.push_back(instant);
    times.push_back(t);
    std::ranges::sort(times);
    const double second = value_at(before), third = value_at(t),
                 first = std::isnan(use->earlier) ? second : value_at(use->earlier);
    const auto [low, high] = std::minmax(second, third);
    if ((second - first) * (third - second) < 0) {
      const double turn = std::min(std::abs(second - first), std::abs(third - second)) -
                          std::max({std::abs(first), std::abs(second), std::abs(third)});
      if (turn > use->unseen) use->unseen = turn, use->unseen_at = before;
    }
    for (std::size_t i = 1; i < times.size(); ++i) {
      const double middle = 0.5 * (times[i - 1] + times[i]), value = value_at(middle),
                   unseen = std::max(value - high, low - value);
      if (unseen > use->unseen) use->unseen = unseen, use->unseen_at = middle;
    }
    for (std::size_t i = 0; i < noted.size(); ++i)
      tables_in_use[i].use->lowest = noted[i].lowest, tables_in_use[i].use->highest = noted[i].highest;
  }

  std::size_t column_of(const mu::Parser::exception_type& e) const {
    return e.GetPos() < 0 ? 1 : std::min(static_cast<std::size_t>(e.GetPos()), text.size()) + 1;
  }

  static std::string reason_of(const mu::Parser::exception_type& e) {
    if (e.GetCode() == mu::ecMISSING_PARENS) return "a ')' is missing";
    if (e.GetCode() == mu::ecUNEXPECTED_EOF) return "it ends too early";
    if (e.GetToken().empty()) return "it is not a complete expression";
    return "unexpected '" + e.GetToken() + "'";
  }

  [[noreturn]] void fail(std::size_t column, const std::string& what) const {
    throw Error(
        "{}cannot parse the expression '{}' at column {}: {}. An expression may contain the variables x, y, z [m] and t [s], "
        "the constant pi, the operators + - * / ^ < > == && || ?: and functions such as sin, cos, exp, sqrt, abs, min, max.",
        where.empty() ? "" : where + ": ", text, column, what);
  }

  [[noreturn]] void fail_unknown(const std::string& name) const {
    const auto found = text.find(name);
    fail(found == std::string::npos ? 1 : found + 1, "unknown name '" + name + "'");
  }

  /// Throws Error if the value is not finite or outside the range of its key.
  void require_possible(double value) const {
    if (std::isfinite(value) && key.contain(value)) return;
    throw Error("{}the expression '{}' yields {} at x = {:g}, y = {:g}, z = {:g}, t = {:g}; it must be {}.",
                where.empty() ? "" : where + ": ", text, base::format_quantity(value, key.unit), xyzt[0],
                xyzt[1], xyzt[2], xyzt[3], std::isfinite(value) ? config::describe_range(key) : "finite");
  }

  double at(const Vec3& x, double t) {
    if (use && uses_time) search_between(x, t);
    xyzt = {x[0], x[1], x[2], t};
    const double value = parser.Eval();
    require_possible(value);
    if (use) {
      if (!use->is_used() || std::abs(value) > use->largest()) use->place = x;
      use->note(value);
    }
    return value;
  }
};

std::map<std::string, Use>& uses() {
  static std::map<std::string, Use> all;
  return all;
}

Expression::Expression() : state_(std::make_unique<ParserState>()) {}
Expression::Expression(const config::ExpressionText& text, std::string where)
    : state_(std::make_unique<ParserState>(text, std::move(where))) {}
Expression::Expression(double constant) : state_(std::make_unique<ParserState>()) {
  state_->text = fmt::format("{}", constant);
  state_->constant = constant;
}
Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

double Expression::operator()(const Vec3& x, double t) const {
  return uses_space() || uses_time() ? state_->at(x, t) : state_->constant;
}

void Expression::evaluate(std::span<const Vec3> points, double t, std::span<double> values, int stride,
                          int offset) const {
  const bool same_everywhere = !uses_space();
  const double common = same_everywhere ? (*this)(Vec3::Zero(), t) : 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    values[stride * i + offset] = same_everywhere ? common : state_->at(points[i], t);
}

const std::string& Expression::text() const { return state_->text; }
bool Expression::uses_time() const { return state_->uses_time; }
bool Expression::uses_space() const { return state_->uses_space; }
bool Expression::is_zero() const { return !uses_time() && !uses_space() && state_->constant == 0; }

std::vector<Expression> make_expressions(const std::vector<config::ExpressionText>& texts, int dim,
                                         const std::string& where) {
  if (std::ssize(texts) != dim)
    throw Error("{}: {} components are given, but the {}-dimensional case needs {}.", where, texts.size(),
                dim, dim);
  std::vector<Expression> expressions;
  for (int c = 0; c < dim; ++c) expressions.emplace_back(texts[c], fmt::format("{}[{}]", where, c));
  return expressions;
}

std::string problem_of(const config::ExpressionText& text) {
  try {
    const Expression expression(text);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

}  // namespace couplet::fv
