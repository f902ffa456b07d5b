// SPDX-License-Identifier: Apache-2.0
#include "common/modes/lowest_quotient.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::modes {
namespace {

// Of a direction that is left of another one by rounding.
constexpr double left_of_direction = 1e-10;

/// A vector with A and B times it.
struct Direction {
  std::vector<double> x, a, b;
};

class QuotientSearch {
 public:
  QuotientSearch(MPI_Comm comm, const QuotientOperators& of) : comm_(comm), of_(of) {}

  double dot(const std::vector<double>& x, const std::vector<double>& y) const {
    double local = 0;
    for (std::size_t i = 0; i < x.size(); ++i) local += x[i] * y[i];
    return parallel::sum(comm_, local);
  }
  void multiply(Direction& d) const {
    d.a.resize(d.x.size());
    d.b.resize(d.x.size());
    of_.a(d.x, d.a);
    of_.b(d.x, d.b);
  }
  static void add(Direction& to, double factor, const Direction& from) {
    for (std::size_t i = 0; i < to.x.size(); ++i) {
      to.x[i] += factor * from.x[i];
      to.a[i] += factor * from.a[i];
      to.b[i] += factor * from.b[i];
    }
  }
  static void scale(Direction& d, double factor) {
    for (auto* values : {&d.x, &d.a, &d.b})
      for (double& v : *values) v *= factor;
  }
  /// To length 1 by B beside the others; false: nothing is left of it.
  bool normalise(Direction& d, std::initializer_list<const Direction*> others) const {
    const double before = dot(d.x, d.b);
    if (!(before > 0)) return false;
    for (int twice = 0; twice < 2; ++twice)
      for (const Direction* other : others) add(d, -dot(d.x, other->b), *other);
    const double square = dot(d.x, d.b);
    if (!(square > left_of_direction * left_of_direction * before)) return false;
    scale(d, 1 / std::sqrt(square));
    return true;
  }
  const QuotientOperators& of() const { return of_; }

 private:
  MPI_Comm comm_;
  const QuotientOperators& of_;
};

}  // namespace

LowestQuotient lowest_quotient(MPI_Comm comm, const QuotientOperators& of, std::vector<double> start,
                               int most_iterations,
                               const std::function<bool(const std::vector<double>&)>& enough) {
  const QuotientSearch search(comm, of);
  const std::size_t n = start.size();
  Direction x{std::move(start), {}, {}}, w{std::vector<double>(n), {}, {}}, p;
  LowestQuotient result;
  search.multiply(x);
  if (!search.normalise(x, {})) return result;
  std::vector<double> residual(n), values;
  bool has_p = false;
  for (; result.iterations < most_iterations; ++result.iterations) {
    const double rho = search.dot(x.x, x.a);
    values.push_back(rho);
    if (result.iterations > 0 && enough(values)) break;
    for (std::size_t i = 0; i < n; ++i) residual[i] = x.a[i] - rho * x.b[i];
    of.precondition(residual, w.x);
    search.multiply(w);
    has_p = has_p && search.normalise(p, {&x});
    const bool has_w = has_p ? search.normalise(w, {&x, &p}) : search.normalise(w, {&x});
    if (!has_w) break;
    const std::array<const Direction*, 3> all{&x, &w, &p};
    const int size = has_p ? 3 : 2;
    Eigen::MatrixXd small(size, size);
    for (int i = 0; i < size; ++i)
      for (int j = 0; j <= i; ++j)
        small(i, j) = small(j, i) = search.dot(all[std::size_t(i)]->x, all[std::size_t(j)]->a);
    const Eigen::VectorXd best = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(small).eigenvectors().col(0);
    Direction step = w;
    QuotientSearch::scale(step, best[1]);
    if (has_p) QuotientSearch::add(step, best[2], p);
    QuotientSearch::scale(x, best[0]);
    QuotientSearch::add(x, 1, step);
    p = std::move(step);
    has_p = true;
  }
  result.value = values.empty() ? 0 : values.back();
  result.x = std::move(x.x);
  return result;
}

}  // namespace couplet::modes
