// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/lanes/vector_passes.hpp"

#include "common/base/processor_clones.hpp"
#include "common/linalg/lanes/slices.hpp"

namespace couplet::linalg {

using Doubles = Eight<double>;

COUPLET_PROCESSOR_CLONES double sum_of(std::span<const double> v) {
  Doubles sum{}, a;
  std::size_t i = 0;
  for (; i + slice_width <= v.size(); i += slice_width) load(v.data() + i, a), sum += a;
  double rest = 0;
  for (; i < v.size(); ++i) rest += v[i];
  return sum_of<double>(sum) + rest;
}

COUPLET_PROCESSOR_CLONES void shift(double by, std::span<double> v) {
  for (double& value : v) value += by;
}

COUPLET_PROCESSOR_CLONES double sum_of_squares(std::span<const double> v) {
  Doubles sum{}, a;
  std::size_t i = 0;
  for (; i + slice_width <= v.size(); i += slice_width) load(v.data() + i, a), sum += a * a;
  double rest = 0;
  for (; i < v.size(); ++i) rest += v[i] * v[i];
  return sum_of<double>(sum) + rest;
}

COUPLET_PROCESSOR_CLONES std::array<double, 2> two_products(std::span<const double> z,
                                                            std::span<const double> r,
                                                            std::span<const double> q) {
  Doubles zr{}, zq{}, a, b, c;
  std::size_t i = 0;
  for (; i + slice_width <= z.size(); i += slice_width) {
    load(z.data() + i, a), load(r.data() + i, b), load(q.data() + i, c);
    zr += a * b, zq += a * c;
  }
  std::array<double, 2> rest{};
  for (; i < z.size(); ++i) rest[0] += z[i] * r[i], rest[1] += z[i] * q[i];
  return {sum_of<double>(zr) + rest[0], sum_of<double>(zq) + rest[1]};
}

COUPLET_PROCESSOR_CLONES void turn(double beta, std::span<const double> z, std::span<double> p) {
  Doubles a, b;
  std::size_t i = 0;
  for (; i + slice_width <= p.size(); i += slice_width) {
    load(z.data() + i, a), load(p.data() + i, b);
    store(a + beta * b, p.data() + i);
  }
  for (; i < p.size(); ++i) p[i] = z[i] + beta * p[i];
}

COUPLET_PROCESSOR_CLONES double go_along(double alpha, std::span<const double> p, std::span<const double> q,
                                         std::span<double> x, std::span<double> r) {
  Doubles sum{}, a, b, c;
  std::size_t i = 0;
  for (; i + slice_width <= p.size(); i += slice_width) {
    load(p.data() + i, a), load(x.data() + i, b);
    store(b + alpha * a, x.data() + i);
    load(q.data() + i, a), load(r.data() + i, b);
    c = b - alpha * a;
    store(c, r.data() + i);
    sum += c * c;
  }
  double rest = 0;
  for (; i < p.size(); ++i) {
    x[i] += alpha * p[i];
    r[i] -= alpha * q[i];
    rest += r[i] * r[i];
  }
  return sum_of<double>(sum) + rest;
}

}  // namespace couplet::linalg
