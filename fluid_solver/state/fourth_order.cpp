// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/state/state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

namespace {

constexpr double parallel_cosine = 0.9999;  // of two faces
// Largest non-orthogonality and skewness (in cell distances) for a face to be straight across its line.
constexpr double straight = 0.02;
constexpr double along_axis = 1e-12;  // of the cosine
constexpr double smooth = 2;          // ratio of the distances on the two sides of a cell

/// A face from the point of view of one of its cells.
struct CellFace {
  Index face, other;
  bool outward;  ///< S points out of the cell
};

template <int D>
bool is_straight(const Placement<D>& at, Index f) {
  const double size = at.area[f].norm();
  if (at.oblique_of(f).norm() > straight * size) return false;
  return !at.skewed() || at.skew[f].norm() * at.conductance[f] <= straight * size;
}

/// Sides of each owned cell with as many faces as a quadrilateral or hexahedron.
template <int D>
std::vector<std::vector<CellFace>> sides_of(const mesh::Mesh& mesh, const Placement<D>& at) {
  const Index owned = mesh.cells.n_owned();
  std::vector<std::vector<CellFace>> sides(static_cast<std::size_t>(owned));
  std::vector<int> faces(static_cast<std::size_t>(owned), 0);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Index p = mesh.owner[f], n = f < mesh.n_interior ? mesh.neighbour[f] : p;
    const bool counts = f < mesh.n_interior && is_straight(at, f);
    if (p < owned) ++faces[std::size_t(p)];
    if (p < owned && counts) sides[std::size_t(p)].push_back({f, n, true});
    if (n == p || n >= owned) continue;
    ++faces[std::size_t(n)];
    if (counts) sides[std::size_t(n)].push_back({f, p, false});
  }
  for (std::size_t c = 0; c < sides.size(); ++c)
    if (faces[c] != 2 * D) sides[c].clear();
  return sides;
}

template <int D>
Vec<D> outward(const Placement<D>& at, const CellFace& side) {
  return (side.outward ? 1 : -1) * at.area[side.face].normalized();
}

template <int D>
int axis_of(const Vec<D>& area) {
  for (int d = 0; d < D; ++d)
    if (std::abs(area[d]) > (1 - along_axis) * area.norm()) return d;
  return -1;
}

/// Circulates a flux e through `before`, `after` and back through the middle cell, with the mean velocities
/// of each two. It conserves momentum and energy. e = -U/6 with U = (u - Du/6).S raises the fluxes to fourth
/// order. Friction likewise: q = nu (g_1 x - g_2 y)/6 out of the middle, to each side by its conductance.
template <int D>
COUPLET_PROCESSOR_CLONES void circulate(std::span<const CellTriple> links, const Vec<D>* area, double nu,
                                        const Vec<D>* u, Vec<D>* rate) {
  const CellTriple *link = links.data(), *const end = link + links.size();
  while (link != end) {
    const Index c = link->cell;
    const Vec<D> middle = u[c];
    Vec<D> sum = Vec<D>::Zero();
    do {
      const Vec<D> x = middle - u[link->before], y = u[link->after] - middle;
      const int d = link->axis;
      const double flux = d < 0 ? (middle - (y - x) / 6).dot(area[link->face])
                                : (middle[d] - (y[d] - x[d]) / 6) * area[link->face][d];
      const double half = flux / -12, before = nu / 6 * link->g_before, after = nu / 6 * link->g_after;
      const double share = link->g_before / (link->g_before + link->g_after);
      const Vec<D> q = before * x - after * y;
      rate[link->before] += share * q - half * y;
      rate[link->after] += (1 - share) * q - half * x;
      sum += half * (x + y) - q;
    } while (++link != end && link->cell == c);
    rate[c] += sum;
  }
}

/// to -= n (n.Du)/(6 V) for each link; V = 1 if nullptr.
template <bool Weighted, int D>
[[gnu::always_inline]] inline void subtract_differences(std::span<const CellTriple> links, const Vec<D>* area,
                                                        const double* volume, const Vec<D>* u, Vec<D>* to) {
  for (const CellTriple& link : links) {
    const Vec<D>&a = u[link.before], &c = u[link.cell], &b = u[link.after];
    const double sixth = Weighted ? 1 / (6 * volume[link.cell]) : 1.0 / 6;
    if (const int d = link.axis; d >= 0) {
      to[link.cell][d] -= sixth * (a[d] - 2 * c[d] + b[d]);
    } else {
      const Vec<D>& s = area[link.face];
      to[link.cell] -= sixth * (a - 2 * c + b).dot(s) / s.dot(s) * s;
    }
  }
}
template <int D>
COUPLET_PROCESSOR_CLONES void difference_pass(std::span<const CellTriple> links, const Vec<D>* area,
                                              const double* volume, const Vec<D>* u, Vec<D>* to) {
  volume ? subtract_differences<true, D>(links, area, volume, u, to)
         : subtract_differences<false, D>(links, area, nullptr, u, to);
}

}  // namespace

template <int D>
Lines<D>::Lines(const mesh::Mesh& mesh, const Placement<D>& at) {
  const auto sides = sides_of(mesh, at);
  for (std::size_t c = 0; c < sides.size(); ++c)
    for (std::size_t i = 0; i < sides[c].size(); ++i)
      for (std::size_t j = i + 1; j < sides[c].size(); ++j) {
        CellFace first = sides[c][i], second = sides[c][j];
        if (outward(at, first).dot(outward(at, second)) > -parallel_cosine) continue;
        // S of `face` points from before to after: outward at `second`, or inward at `first`.
        if (!second.outward && first.outward) std::swap(first, second);
        const double before = at.conductance[first.face], after = at.conductance[second.face];
        if (std::max(before, after) > smooth * std::min(before, after)) continue;
        const Index face = second.outward ? second.face : first.face;
        links.push_back({first.other, static_cast<Index>(c), second.other, face, axis_of<D>(at.area[face]),
                         before, after});
      }
  const double counts[2] = {double(links.size()), double(D) * mesh.cells.n_owned()};
  std::array<double, 2> sums{};
  MPI_Allreduce(counts, sums.data(), 2, MPI_DOUBLE, MPI_SUM, mesh.comm);
  share = sums[1] > 0 ? sums[0] / sums[1] : 0;
}

template <int D>
std::shared_ptr<const Placement<D>> Lines<D>::seen(const mesh::Mesh& mesh, const Placement<D>& at) const {
  std::vector<Tensor<D>> along(mesh.cells.n_local(), Tensor<D>::Zero());  // sum of n n^T of a cell's links
  for (const CellTriple& link : links) {
    const Vec<D> n = at.area[link.face].normalized();
    along[link.cell] += n * n.transpose();
  }
  mesh.cells.update_ghosts({along.empty() ? nullptr : along.front().data(), along.size() * D * D}, D * D);
  std::vector<char> between(mesh.n_interior, 0);
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Vec<D> n = at.area[f].normalized();
    const auto has_link = [&](Index c) { return n.dot(along[c] * n) > 0.5; };
    between[f] = is_straight(at, f) && has_link(mesh.owner[f]) && has_link(mesh.neighbour[f]);
  }
  return in_the_middle<D>(mesh, at, between);
}

template <int D>
void FourthOrder<D>::add_rates(const State<D>& s, double nu, Vectors<D>& rate) const {
  std::fill(rate.begin() + mesh_.cells.n_owned(), rate.end(), Vec<D>::Zero());
  circulate<D>(lines_.links, s.placement->area.data(), nu, s.u.data(), rate.data());
  mesh_.cells.add_to_owners(flat<D>(rate), D);
}

template <int D>
const Vectors<D>& FourthOrder<D>::flux_velocity(const Placement<D>& at, const Vectors<D>& u) {
  flux_velocity_ = u;
  difference_pass<D>(lines_.links, at.area.data(), nullptr, u.data(), flux_velocity_.data());
  mesh_.cells.update_ghosts(flat<D>(flux_velocity_), D);
  return flux_velocity_;
}

template <int D>
void FourthOrder<D>::sharpen(const Placement<D>& at, Vectors<D>& gradient) const {
  Vectors<D> whole(gradient.size());
  for (std::size_t c = 0; c < whole.size(); ++c) whole[c] = at.volume[c] * gradient[c];
  difference_pass<D>(lines_.links, at.area.data(), at.volume.data(), whole.data(), gradient.data());
  mesh_.cells.update_ghosts(flat<D>(gradient), D);
}

template <int D>
double FourthOrder<D>::dissipation(double mu, const Vectors<D>& u) const {
  double sum = 0;
  for (const CellTriple& link : lines_.links) {
    const Vec<D> x = u[link.cell] - u[link.before], y = u[link.after] - u[link.cell];
    sum += (link.g_before * x - link.g_after * y).squaredNorm() / (link.g_before + link.g_after);
  }
  return mu / 6 * sum;
}

template struct Lines<2>;
template struct Lines<3>;
template class FourthOrder<2>;
template class FourthOrder<3>;

}  // namespace couplet::fluid
