// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"

namespace couplet::fv {

/// A compiled function of x, y, z [m] and t [s] in muParser syntax: "2*sin(pi*x)", "t < 7 ? -125*t/7 : 0".
/// Tables are functions in it (see table.hpp): "1e5*table(t, 0, 0, 2, 1, 5, 0.5)", 'table(z, "p.csv")'.
class Expression {
 public:
  Expression();  ///< zero
  /// `where` is the key it stands for, for messages. Throws Error with the column inside the expression, what
  /// is wrong there and which variables are known.
  explicit Expression(const config::ExpressionText& text, std::string where = "");
  explicit Expression(double constant);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  /// Throws Error if the value is not finite.
  double operator()(const Vec3& x, double t) const;
  /// values[stride * i + offset] = f(points[i], t): `stride` 3 and `offset` c fill component c of packed
  /// vectors.
  void evaluate(std::span<const Vec3> points, double t, std::span<double> values, int stride = 1,
                int offset = 0) const;

  const std::string& text() const;
  bool uses_time() const;
  bool uses_space() const;
  /// Neither space nor time, and 0: whoever asks can skip the work.
  bool is_zero() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One expression a component. `texts` must have `dim` entries (Error otherwise, naming `where`).
std::vector<Expression> make_expressions(const std::vector<config::ExpressionText>& texts, int dim,
                                         const std::string& where);

/// What is wrong with the texts, as a configuration check wants it; empty if there are `n` and they can be
/// read.
std::string problem_of(const std::vector<config::ExpressionText>& texts, int n);
std::string problem_of(const config::ExpressionText& text);

}  // namespace couplet::fv
