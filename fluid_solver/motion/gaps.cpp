// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/base/point_tree.hpp"
#include "common/base/text.hpp"
#include "common/fv/expression.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

namespace {

// Allowed net share of the flux through a pocket's inlets, due to their profiles.
constexpr double inlet_leftover = 1e-6;

constexpr double near_enough = 0.1;  // of the opening
// Share of the conductance kept by a blocked face. The leak is equally small, and the pressure in the gap
// follows lubrication theory of a slot between its two ends (linear in a parallel slot).
constexpr double kept = 1e-6;

Vec3 direction_of(const GapParameters& gap, int dimension) {
  const std::vector<double>& d = gap.direction;
  if (d.empty()) return dimension == 2 ? Vec3::UnitY() : Vec3::UnitZ();
  return Vec3(d[0], d[1], d.size() > 2 ? d[2] : 0).normalized();
}

/// Distance of x from segments (2-D) or triangles, whose corners are stored consecutively.
template <int D>
double distance(const Vec3& x, const std::vector<double>& corners) {
  double least = base::infinity;
  const auto corner = [&](std::size_t i) { return Vec3(Eigen::Map<const Vec3>(corners.data() + 3 * i)); };
  for (std::size_t i = 0; i + D <= corners.size() / 3; i += D)
    least = std::min(
        least, D == 2 ? base::nearest_on_segment(corner(i), corner(i + 1), x).distance
                      : base::nearest_on_triangle(corner(i), corner(i + 1), corner(i + D - 1), x).distance);
  return least;
}

/// Checks that the second wall of each gap with a `height` is the seat that the structure lands on. Throws
/// Error if a point is off by more than a tenth of the opening. Collective.
void check_seats(const mesh::Mesh& mesh, const FluidParameters& parameters, std::span<const Vec3> points) {
  for (const auto& [name, gap] : parameters.gaps) {
    const mesh::Patch* seat = gap.height ? mesh.find_patch(gap.between[1]) : nullptr;
    if (seat == nullptr) continue;
    const fv::Expression height(*gap.height, "gaps." + name + ".height");
    const Vec3 direction = direction_of(gap, mesh.dim);
    std::vector<double> worst{0, 0, 0, 0, 0};  // off by, place, height given there
    for (Index f = seat->first; f < seat->first + seat->count; ++f)
      for (const Index p : mesh.face_points[f]) {
        const Vec3& x = points[p];
        const double given = height(x, 0), off = x.dot(direction) - given;
        if (std::abs(off) > std::abs(worst[0])) worst = {off, x.x(), x.y(), x.z(), given};
      }
    const std::vector<double> all = parallel::all_gather(mesh.comm, worst);
    for (std::size_t i = 0; i < all.size(); i += 5)
      if (std::abs(all[i]) > std::abs(worst[0])) worst.assign(all.begin() + i, all.begin() + i + 5);
    if (std::abs(worst[0]) <= near_enough * gap.opening) continue;
    throw Error(
        "gaps.{0}.height: the seat is stated at {1:.4g} m, but the mesh has its wall '{2}' {3:.3g} m {4} at ({5:.4g}, {6:.4g}, "
        "{7:.4g}), more than {8:g} % of the opening ({9:g} m). Correct 'height', or the mesh.",
        name, worst[4], gap.between[1], std::abs(worst[0]), worst[0] > 0 ? "above it" : "below it", worst[1],
        worst[2], worst[3], 100 * near_enough, gap.opening);
  }
}

/// Extends a box by the points of a patch. Collective.
void extend(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> points, Vec3& low,
            Vec3& high) {
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index v : mesh.face_points[f]) low = low.cwiseMin(points[v]), high = high.cwiseMax(points[v]);
  MPI_Allreduce(MPI_IN_PLACE, low.data(), 3, MPI_DOUBLE, MPI_MIN, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, high.data(), 3, MPI_DOUBLE, MPI_MAX, mesh.comm);
}

/// Corners of faces on all ranks that intersect a box, as segments (2-D) or triangles. Collective.
std::vector<double> corners_of(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> points,
                               const Vec3& low, const Vec3& high) {
  std::vector<double> mine;
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const auto v = mesh.face_points[f];
    Vec3 least = points[v[0]], most = least;
    for (const Index p : v) least = least.cwiseMin(points[p]), most = most.cwiseMax(points[p]);
    if ((least.array() > high.array()).any() || (most.array() < low.array()).any()) continue;
    const auto add = [&](std::initializer_list<std::size_t> corner) {
      for (const std::size_t i : corner)
        mine.insert(mine.end(), points[v[i]].data(), points[v[i]].data() + 3);
    };
    if (mesh.dim == 2) add({0, 1});
    for (std::size_t i = 2; mesh.dim == 3 && i < v.size(); ++i) add({0, i - 1, i});
  }
  return parallel::all_gather(mesh.comm, mine);
}

bool inside(const Vec3& x, const Vec3& low, const Vec3& high) {
  return (x.array() >= low.array()).all() && (x.array() <= high.array()).all();
}

}  // namespace

template <int D>
GapPockets<D>::GapPockets(const mesh::Mesh& mesh, const FluidParameters& parameters) : mesh_(mesh) {
  for (const mesh::Patch& patch : mesh.patches) {
    const BoundaryParameters& b = parameters.boundaries.at(patch.name);
    if (condition_of(b).passage != Passage::none) (gives_pressure(b) ? open_ : given_).push_back(&patch);
  }
}

/// Propagates the lowest label over faces between free cells and across ranks until nothing changes.
template <int D>
void GapPockets<D>::find(const std::vector<int>& gap) {
  label_.assign(mesh_.cells.n_local(), 0.0);
  for (Index c = 0; c < mesh_.cells.n_local(); ++c)
    if (gap[c] < 0) label_[c] = double(mesh_.cell_id[c]) + 1;
  std::vector<double> before;
  do {
    before = label_;
    for (bool spreads = true; spreads;) {
      spreads = false;
      const auto join = [&](Index f) {
        double &p = label_[mesh_.owner[f]], &n = label_[mesh_.neighbour[f]];
        if (p == 0 || n == 0 || p == n) return;
        p = n = std::min(p, n);
        spreads = true;
      };
      for (Index f = 0; f < mesh_.n_interior; ++f) join(f);
      for (Index f = mesh_.n_interior; f-- > 0;) join(f);
    }
    mesh_.cells.update_ghosts(label_);
  } while (parallel::any(mesh_.comm, before != label_));
  std::vector<double> all, open;
  for (const double label : label_) all.push_back(label);
  for (const mesh::Patch* patch : open_)
    for (Index f = patch->first; f < patch->first + patch->count; ++f) open.push_back(label_[mesh_.owner[f]]);
  for (auto* labels : {&all, &open}) {
    std::ranges::sort(*labels);
    labels->erase(std::unique(labels->begin(), labels->end()), labels->end());
    *labels = parallel::all_gather(mesh_.comm, *labels);
    std::ranges::sort(*labels);
    labels->erase(std::unique(labels->begin(), labels->end()), labels->end());
  }
  shut_.clear();
  std::ranges::set_difference(all, open, std::back_inserter(shut_));
}

template <int D>
void GapPockets<D>::check(const Placement<D>& at, const Vectors<D>& w, double time, bool compressible) const {
  if (shut_.empty()) return;
  // Net outflow of each pocket and the sum of absolute values, in total and per patch, for messages.
  const std::size_t n = shut_.size();
  std::vector<double> sums(n * (1 + given_.size()), 0.0), sizes(sums.size(), 0.0);
  for (std::size_t g = 0; g < given_.size(); ++g)
    for (Index f = given_[g]->first; f < given_[g]->first + given_[g]->count; ++f) {
      const double label = label_[mesh_.owner[f]];
      const auto found = std::ranges::lower_bound(shut_, label);
      if (found == shut_.end() || *found != label) continue;
      const std::size_t pocket = found - shut_.begin();
      const double flux = w[f - mesh_.n_interior].dot(at.area[f]);
      for (const std::size_t i : {pocket, n * (1 + g) + pocket}) sums[i] += flux, sizes[i] += std::abs(flux);
    }
  const int count = static_cast<int>(sums.size());
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), count, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  MPI_Allreduce(MPI_IN_PLACE, sizes.data(), count, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  for (std::size_t i = 0; i < n; ++i) {
    const bool in_blocked_cells = shut_[i] == 0;
    if (compressible && !in_blocked_cells) continue;
    if ((in_blocked_cells ? sizes[i] : std::abs(sums[i])) <= inlet_leftover * sizes[i]) continue;
    std::vector<std::string> names;
    for (std::size_t g = 0; g < given_.size(); ++g)
      if (sizes[n * (1 + g) + i] > 0) names.push_back(given_[g]->name);
    if (in_blocked_cells)
      throw SchemeFailure(
          "gaps: at t = {:.6g} s the closed gap reaches '{}', where {:.3g} m^3/s would cross its blocked "
          "cells. Keep the gap wider than 'opening' there, or reduce that velocity to zero before it closes.",
          time, base::join(names), sizes[i]);
    throw SchemeFailure(
        "gaps: at t = {:.6g} s the closed gap separates '{}' from every outlet, but {:.3g} m^3/s are to "
        "flow {} there, which cannot be balanced. Give that part of the fluid an outlet, reduce the "
        "velocity to zero before the gap closes, or prescribe a pressure instead (type outlet).",
        time, base::join(names), std::abs(sums[i]), sums[i] < 0 ? "in" : "out");
  }
}

template <int D>
std::string GapPockets<D>::cause(const Placement<D>& at) const {
  if (shut_.empty() || shut_.back() == 0) return {};
  double sums[D + 1] = {};  // of the last one's cells: places, number
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    if (label_[c] != shut_.back()) continue;
    for (int i = 0; i < D; ++i) sums[i] += at.centre[c][i];
    sums[D] += 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, D + 1, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  return fmt::format(
      "A closed gap has separated {} cells around ({:.4g}, {:.4g}, {:.4g}) m from every outlet: the volume "
      "that their walls displace cannot leave. Give that part of the fluid an outlet, or block it as well.",
      GlobalIndex(sums[D]), sums[0] / sums[D], sums[1] / sums[D], D == 3 ? sums[2] / sums[D] : 0.0);
}

template class GapPockets<2>;
template class GapPockets<3>;

template <int D>
Gaps<D>::Gaps(const mesh::Mesh& mesh, const FluidParameters& parameters, std::span<const Vec3> points)
    : Obstacles<D>(mesh),
      pockets_(mesh, parameters),
      compressible_(parameters.is_compressible()),
      never_(mesh.cells.n_local(), 0),
      gap_(mesh.cells.n_local(), -1) {
  check_seats(mesh, parameters, points);
  std::vector<std::string> there;
  for (const mesh::Patch& patch : mesh.patches) there.push_back(patch.name);
  for (const auto& [name, gap] : parameters.gaps) {
    names_.push_back(name);
    limit_.push_back(gap.opening);
    walls_.emplace_back();
    for (int side = 0; side < 2; ++side) {
      const std::string& patch = gap.between[side];
      if (!mesh.find_patch(patch))
        throw Error("gaps.{}.between: the mesh has no patch '{}'. {}", name, patch,
                    base::did_you_mean(patch, there, "patches"));
      if (!is_wall(parameters.boundaries.at(patch)))
        throw Error("gaps.{}.between: '{}' is not a wall; a gap lies between two walls.", name, patch);
      walls_.back()[side] = mesh.find_patch(patch);
    }
  }
  facts_.resize(names_.size());
  std::vector<double> never(mesh.cells.n_local(), 0.0);
  for (const mesh::Patch& patch : mesh.patches)
    if (gives_pressure(parameters.boundaries.at(patch.name)))
      for (Index f = patch.first; f < patch.first + patch.count; ++f) never[mesh.owner[f]] = 1;
  mesh.cells.update_ghosts(never);
  for (std::size_t c = 0; c < never.size(); ++c) never_[c] = never[c] != 0;
}

template <int D>
void Gaps<D>::mark_gap(int gap, std::span<const Vec3> points, const Placement<D>& at) {
  const double limit = limit_[gap];
  GapState& facts = facts_[gap];
  facts = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
  std::array<Vec3, 2> low, high;
  for (int side = 0; side < 2; ++side) {
    low[side].setConstant(base::infinity);
    high[side].setConstant(-base::infinity);
    extend(mesh_, *walls_[gap][side], points, low[side], high[side]);
  }
  // A blocked cell is nearer than the limit to both walls.
  const Vec3 room = Vec3::Constant(limit), from = low[0].cwiseMax(low[1]) - room,
             to = high[0].cwiseMin(high[1]) + room;
  if ((from.array() > to.array()).any()) return;
  const auto corners = [&](int side) {
    return corners_of(mesh_, *walls_[gap][side], points, from - room, to + room);
  };
  const std::vector<double> one = corners(0), other = corners(1);
  double least = base::infinity, sums[2] = {0, 0};
  for (Index c = 0; c < mesh_.cells.n_local(); ++c) {
    Vec3 x = Vec3::Zero();
    x.template head<D>() = at.centre[c];
    if (!inside(x, from, to)) continue;
    const double opening = distance<D>(x, one) + distance<D>(x, other);
    least = std::min(least, opening);
    if (opening >= limit || never_[c]) continue;
    gap_[c] = gap;
    if (c >= mesh_.cells.n_owned()) continue;
    sums[0] += 1;
    sums[1] += at.volume[c];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  least = parallel::min(mesh_.comm, least);
  facts = {std::isfinite(least) ? least : facts.opening, sums[0], sums[1]};
}

template <int D>
typename Gaps<D>::Changed Gaps<D>::mark(double, const std::shared_ptr<const Placement<D>>& at,
                                        const std::vector<Vec3>& points) {
  if (marked_ == at) return Changed::nothing;
  marked_ = at;
  const std::vector<int> before = gap_;
  std::fill(gap_.begin(), gap_.end(), -1);
  for (std::size_t g = 0; g < names_.size(); ++g) mark_gap(static_cast<int>(g), points, *at);
  active_ = std::ranges::any_of(facts_, [](const GapState& f) { return f.cells > 0; });
  this->close([&](Index c) { return gap_[c] >= 0; });
  velocity_.assign(gap_.size(), Vec<D>::Zero());
  const bool changed = parallel::any(mesh_.comm, before != gap_);
  if (changed && active_) pockets_.find(gap_);
  around_.reset();
  if (active_) {
    auto around = std::make_shared<Placement<D>>(*at);
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      if (!is_blocked(f)) continue;
      around->conductance[f] *= kept;
      if (!around->oblique.empty()) around->oblique[f].setZero();
    }
    around_ = std::move(around);
  }
  return changed ? Changed::cells : Changed::nothing;
}

template <int D>
void Gaps<D>::begin(const FluidStep<D>& step, const State<D>& from, const Vectors<D>& w) {
  bool other = false;
  for (std::size_t c = 0; c < gap_.size(); ++c)
    other |= (gap_[c] >= 0) != (from.blocked && (*from.blocked)[c]);
  changed_ = parallel::any(mesh_.comm, other);
  if (!active_) return;
  pockets_.check(*step.to, w, step.end(), compressible_);
  for (std::size_t c = 0; c < gap_.size(); ++c)
    if (gap_[c] >= 0) velocity_[c] = (step.to->centre[c] - from.placement->centre[c]) / step.dt;
}

template <int D>
void Gaps<D>::hold(const Placement<D>&, double, Vectors<D>& u) const {
  for (std::size_t c = 0; active_ && c < gap_.size(); ++c)
    if (gap_[c] >= 0) u[c] = velocity_[c];
}

template <int D>
void Gaps<D>::block(const FluidStep<D>& step, std::vector<double>& phi) const {
  for (Index f = 0; active_ && f < mesh_.n_interior; ++f)
    if (is_blocked(f)) phi[f] = step.moving() ? step.swept[f] / step.dt : 0;
}

template <int D>
void Gaps<D>::correct_memory(State<D>& s) const {
  for (Index f = 0; active_ && f < mesh_.n_interior; ++f)
    if (is_blocked(f)) s.memory[f] = 0;
}

/// With linear interpolation, the free cell would see the pressure gradient in the gap, which drives no flow.
template <int D>
void Gaps<D>::part(const Placement<D>& at, const std::vector<double>& p, const Vectors<D>* gradient,
                   const Vectors<D>& area, Vectors<D>& sum) const {
  for (Index f = 0; active_ && f < mesh_.n_interior; ++f) {
    if (!is_blocked(f)) continue;
    const Index o = mesh_.owner[f], n = mesh_.neighbour[f];
    double linear = at.weight[f] * p[o] + (1 - at.weight[f]) * p[n];
    if (gradient && at.skewed()) linear += skew_part(mesh_, at, *gradient, f);
    if (!is_closed(o)) sum[o] += (p[o] - linear) * area[f];
    if (!is_closed(n)) sum[n] -= (p[n] - linear) * area[f];
  }
}

/// A compressible fluid is compressed in parts that are cut off.
template <int D>
std::string Gaps<D>::cause(const Placement<D>& at) const {
  return active_ && !compressible_ ? pockets_.cause(at) : std::string();
}

template <int D>
std::shared_ptr<const std::vector<char>> Gaps<D>::marks() const {
  if (!active_) return nullptr;
  auto marks = std::make_shared<std::vector<char>>(gap_.size(), 0);
  for (std::size_t c = 0; c < gap_.size(); ++c) (*marks)[c] = gap_[c] >= 0;
  return marks;
}

template class Gaps<2>;
template class Gaps<3>;

}  // namespace couplet::fluid
