// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/lines/fourth_order.hpp"

#include <algorithm>
#include <span>

#include "common/base/processor_clones.hpp"

namespace couplet::fluid {
namespace {

/// A flux e through `before`, `after`, and back through the cell in the middle, with the mean velocities of each two: no momentum
/// and no energy comes of it. e = -U/6, U = (u - Du/6).S makes the fluxes of second order beside it those of fourth. Friction
/// likewise: q = nu (g_1 x - g_2 y)/6 out of the middle, to each side by its conductance.
template <int D>
[[gnu::always_inline]] inline void circulate(std::span<const Link> links, const Vec<D>* area, double nu,
                                             const Vec<D>* u, Vec<D>* rate) {
  const Link *link = links.data(), *const end = link + links.size();
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
COUPLET_PROCESSOR_CLONES void circulation_pass(std::span<const Link> links, const Vec<2>* area, double nu,
                                               const Vec<2>* u, Vec<2>* rate) {
  circulate<2>(links, area, nu, u, rate);
}
COUPLET_PROCESSOR_CLONES void circulation_pass(std::span<const Link> links, const Vec<3>* area, double nu,
                                               const Vec<3>* u, Vec<3>* rate) {
  circulate<3>(links, area, nu, u, rate);
}

/// to -= n (n.Du)/(6 V) of each link; V null: 1.
template <bool Weighted, int D>
[[gnu::always_inline]] inline void subtract_differences(std::span<const Link> links, const Vec<D>* area,
                                                        const double* volume, const Vec<D>* u, Vec<D>* to) {
  for (const Link& link : links) {
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
[[gnu::always_inline]] inline void choose_weights(std::span<const Link> links, const Vec<D>* area,
                                                  const double* volume, const Vec<D>* u, Vec<D>* to) {
  volume ? subtract_differences<true, D>(links, area, volume, u, to)
         : subtract_differences<false, D>(links, area, nullptr, u, to);
}
COUPLET_PROCESSOR_CLONES void difference_pass(std::span<const Link> links, const Vec<2>* area,
                                              const double* volume, const Vec<2>* u, Vec<2>* to) {
  choose_weights<2>(links, area, volume, u, to);
}
COUPLET_PROCESSOR_CLONES void difference_pass(std::span<const Link> links, const Vec<3>* area,
                                              const double* volume, const Vec<3>* u, Vec<3>* to) {
  choose_weights<3>(links, area, volume, u, to);
}

}  // namespace

template <int D>
void FourthOrder<D>::add_rates(const State<D>& s, double nu, Vectors<D>& rate) const {
  std::fill(rate.begin() + mesh_.cells.n_owned(), rate.end(), Vec<D>::Zero());
  circulation_pass(lines_.links, s.placement->area.data(), nu, s.u.data(), rate.data());
  mesh_.cells.add_to_owners(flat<D>(rate), D);
}

template <int D>
const Vectors<D>& FourthOrder<D>::flux_velocity(const Placement<D>& at, const Vectors<D>& u) {
  flux_velocity_ = u;
  difference_pass(lines_.links, at.area.data(), nullptr, u.data(), flux_velocity_.data());
  mesh_.cells.update_ghosts(flat<D>(flux_velocity_), D);
  return flux_velocity_;
}

template <int D>
void FourthOrder<D>::sharpen(const Placement<D>& at, Vectors<D>& gradient) const {
  Vectors<D> whole(gradient.size());
  for (std::size_t c = 0; c < whole.size(); ++c) whole[c] = at.volume[c] * gradient[c];
  difference_pass(lines_.links, at.area.data(), at.volume.data(), whole.data(), gradient.data());
  mesh_.cells.update_ghosts(flat<D>(gradient), D);
}

template <int D>
double FourthOrder<D>::dissipation(double mu, const Vectors<D>& u) const {
  double sum = 0;
  for (const Link& link : lines_.links) {
    const Vec<D> x = u[link.cell] - u[link.before], y = u[link.after] - u[link.cell];
    sum += (link.g_before * x - link.g_after * y).squaredNorm() / (link.g_before + link.g_after);
  }
  return mu / 6 * sum;
}

template class FourthOrder<2>;
template class FourthOrder<3>;

}  // namespace couplet::fluid
