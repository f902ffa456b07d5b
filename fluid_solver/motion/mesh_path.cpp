// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/scene.hpp"

#include <algorithm>
#include <utility>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {
namespace {

// Largest relative motion of the sides of periodic patches, over their distance.
constexpr double most_torn = 1e-8;

/// Rejects inverted cells, whatever moved the points.
template <int D>
void refuse_inverted(const mesh::Mesh& mesh, const Placement<D>& at, double time) {
  bool inverted = false;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) inverted |= !(at.volume[c] > 0);
  if (!parallel::any(mesh.comm, inverted)) return;
  const LargestCell worst = find_largest(mesh, at, [&](Index c) { return -at.volume[c]; });
  throw SolveFailure(
      "The mesh motion from t = {:.6g} s inverts a cell near ({:.6g}, {:.6g}, {:.6g}) m (volume {:.3e} m^3).",
      time, worst.place.x(), worst.place.y(), worst.place.z(), -worst.value);
}

}  // namespace

template <int D>
MeshPath<D>::MeshPath(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                      const FluidParameters& parameters, bool moves)
    : mesh_(mesh),
      points_at_rest_(geometry.points),
      moves_(moves),
      translates_(parameters.motion && parameters.motion->translates()) {
  if (moves_ && !translates_ &&
      parallel::any(mesh.comm, !mesh.neighbour_shift.empty()))  // a rank without cells has none
    periodic_.emplace(mesh, geometry);
}

template <int D>
std::shared_ptr<const Placement<D>> MeshPath<D>::start(const mesh::Geometry& geometry) {
  std::shared_ptr<const Placement<D>> first =
      moves_ ? make_placement<D>(mesh_, geometry.points) : make_placement<D>(mesh_, geometry);
  if (!translates_) return first;
  auto frame = std::make_shared<Placement<D>>(*first);
  frame->shape = std::make_shared<const char>();
  return frame_ = std::move(frame);
}

template <int D>
std::shared_ptr<const Placement<D>> MeshPath<D>::at(std::span<const Vec3> points) const {
  if (!frame_) return make_placement<D>(mesh_, points);
  return translated(*frame_, points.empty() ? Vec3(Vec3::Zero()) : Vec3(points[0] - points_at_rest_[0]));
}

template <int D>
SubStep<D> MeshPath<D>::sub_step(const State<D>& level, double dt, double s, std::span<const Vec3> begin,
                                 std::span<const Vec3> end, double time) const {
  SubStep<D> step;
  step.dt = dt;
  step.to = level.placement;
  if (!moves_) return step;
  if (s == 1 || end.empty()) {
    const std::span<const Vec3> points = end.empty() ? begin : end;
    step.points.assign(points.begin(), points.end());
  } else {
    step.points.resize(end.size());
    for (std::size_t i = 0; i < end.size(); ++i) step.points[i] = begin[i] + s * (end[i] - begin[i]);
  }
  step.to = at(step.points);
  if (!translates_) refuse_inverted(mesh_, *step.to, time);
  step.swept = mesh::swept_volumes(mesh_, level.points, step.points);
  step.swept.resize(mesh_.n_flux_faces());
  return step;
}

template <int D>
void MeshPath<D>::refuse_torn(std::span<const Vec3> points, double time) const {
  if (!periodic_ || points.empty()) return;
  std::vector<double> moved;
  for (std::size_t v = 0; v < points.size(); ++v)
    for (int c = 0; c < mesh_.dim; ++c) moved.push_back(points[v][c] - points_at_rest_[v][c]);
  const double gap = periodic_->largest_gap(moved, mesh_.dim);
  double size = 0;
  for (Index f = 0; f < mesh_.n_interior; ++f) size = std::max(size, mesh_.shift(f).norm());
  if (gap > most_torn * parallel::max(mesh_.comm, size))
    throw Error(
        "The mesh motion to t = {:.6g} s separates the two sides of periodic patches by {:.3g} m. Both must "
        "move alike: set 'type: periodic' for them in the mesh mover as well; a 'motion' must be periodic "
        "from side to side, which a rotation of the whole mesh is not.",
        time, gap);
}

template class MeshPath<2>;
template class MeshPath<3>;

}  // namespace couplet::fluid
