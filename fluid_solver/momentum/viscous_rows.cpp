// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/momentum/viscous_rows.hpp"

#include <algorithm>
#include <array>

#include "common/base/processor_clones.hpp"

namespace couplet::fluid {
namespace {

/// `Width` entries a row, known to the compiler; 0: a.width.
template <int D, int Width>
[[gnu::always_inline]] inline double multiply_rows(const ViscousRows& a, const Vectors<D>& x, Vectors<D>& y) {
  const Index width = Width > 0 ? Width : a.width;
  const Index* column = a.column.data();
  const double* value = a.value.data();
  double sum = 0;
  for (Index c = 0, end = a.size(); c < end; ++c, column += width, value += width) {
    Vec<D> row = a.diagonal[c] * x[c];
    for (Index e = 0; e < width; ++e) row += value[e] * x[column[e]];
    y[c] = row;
    sum += row.dot(x[c]);
  }
  return sum;
}

template <int D>
[[gnu::always_inline]] inline double multiply_by_width(const ViscousRows& a, const Vectors<D>& x,
                                                       Vectors<D>& y) {
  switch (a.width) {
    case 3:
      return multiply_rows<D, 3>(a, x, y);
    case 4:
      return multiply_rows<D, 4>(a, x, y);
    case 6:
      return multiply_rows<D, 6>(a, x, y);
    default:
      return multiply_rows<D, 0>(a, x, y);
  }
}

}  // namespace

ViscousRows::ViscousRows(const mesh::Mesh& mesh) : diagonal(mesh.cells.n_owned()) {
  const Index owned = mesh.cells.n_owned();
  std::vector<Index> count(owned, 0);
  for (Index f = 0; f < mesh.n_interior; ++f)
    for (const Index c : {mesh.owner[f], mesh.neighbour[f]})
      if (c < owned) width = std::max(width, ++count[c]);
  const std::size_t entries = static_cast<std::size_t>(owned) * width;
  column.resize(entries), face.assign(entries, -1), value.assign(entries, 0.0);
  for (std::size_t e = 0; e < entries; ++e) column[e] = static_cast<Index>(e / width);
  count.assign(owned, 0);
  const auto add = [&](Index from, Index to, Index f) {
    if (from >= owned) return;
    const std::size_t e = static_cast<std::size_t>(from) * width + count[from]++;
    column[e] = to, face[e] = f;
  };
  for (Index f = 0; f < mesh.n_interior; ++f) {
    add(mesh.owner[f], mesh.neighbour[f], f);
    add(mesh.neighbour[f], mesh.owner[f], f);
  }
}

COUPLET_PROCESSOR_CLONES double multiply(const ViscousRows& a, const Vectors<2>& x, Vectors<2>& y) {
  return multiply_by_width<2>(a, x, y);
}
COUPLET_PROCESSOR_CLONES double multiply(const ViscousRows& a, const Vectors<3>& x, Vectors<3>& y) {
  return multiply_by_width<3>(a, x, y);
}

COUPLET_PROCESSOR_CLONES double go_along(double alpha, std::span<const double> s, std::span<const double> q,
                                         std::span<double> u, std::span<double> r) {
  std::array<double, 4> sums{};  // side by side, for one register
  std::size_t i = 0;
  for (; i + 4 <= s.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) {
      u[i + k] += alpha * s[i + k];
      r[i + k] -= alpha * q[i + k];
      sums[k] += r[i + k] * r[i + k];
    }
  for (; i < s.size(); ++i) {
    u[i] += alpha * s[i];
    r[i] -= alpha * q[i];
    sums[0] += r[i] * r[i];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

COUPLET_PROCESSOR_CLONES void turn_search(double gamma, std::span<const double> r, std::span<double> s) {
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = r[i] + gamma * s[i];
}

}  // namespace couplet::fluid
