// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"

namespace couplet::fv {

/// Compiled function of x, y, z [m] and t [s] in muParser syntax: "2*sin(pi*x)", "t < 7 ? -125*t/7 : 0".
/// Tables are functions (see table.hpp): "1e5*table(t, 0, 0, 2, 1, 5, 0.5)", 'table(z, "p.csv")'.
class Expression {
 public:
  Expression();  ///< zero
  /// `where` is the key, for messages. Throws Error with the column in the expression, the cause and the
  /// known variables.
  explicit Expression(const config::ExpressionText& text, std::string where = "");
  explicit Expression(double constant);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  /// Throws Error if the value is not finite.
  double operator()(const Vec3& x, double t) const;
  /// Sets values[stride * i + offset] = f(points[i], t). `stride` 3 and `offset` c fill component c of packed
  /// vectors.
  void evaluate(std::span<const Vec3> points, double t, std::span<double> values, int stride = 1,
                int offset = 0) const;

  const std::string& text() const;
  bool uses_time() const;
  bool uses_space() const;
  /// Returns true for the constant 0, so that callers can skip the work.
  bool is_zero() const;

 private:
  struct ParserState;
  std::unique_ptr<ParserState> state_;
};

/// Compiles one expression per component. Throws Error with `where` unless there are `dim` texts.
std::vector<Expression> make_expressions(const std::vector<config::ExpressionText>& texts, int dim,
                                         const std::string& where);

/// Returns what is wrong with a text for a configuration check; empty if it can be parsed.
std::string problem_of(const config::ExpressionText& text);

}  // namespace couplet::fv
