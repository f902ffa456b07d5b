// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/scene.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/fv/use.hpp"
#include "common/io/probes/place_search.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

template <int D>
RotatingFrame<D>::RotatingFrame(const RotationParameters& p)
    : speed_(p.speed, "rotating-frame.speed"),
      centre_(p.centre),
      axis_(D == 2 ? Vec3(Vec3::UnitZ()) : Vec3(p.axis.normalized())) {
  fv::check_axis(p.axis, D, "rotating-frame.axis");
  if (speed_.uses_space()) throw Error("rotating-frame.speed: it may depend on t only.");
}

template <int D>
void RotatingFrame<D>::add(double t, double dt, std::span<const Vec3> places, const Vectors<D>& u,
                           Vectors<D>& force) const {
  const Vec3 omega = speed(t + dt / 2) * axis_, change = (speed(t + dt) - speed(t)) / dt * axis_;
  for (std::size_t c = 0; c < places.size(); ++c) {
    Vec3 velocity = Vec3::Zero();
    velocity.template head<D>() = u[c];
    force[c] -= (2 * omega.cross(velocity) + change.cross(places[c] - centre_)).template head<D>();
  }
}

template <int D>
double RotatingFrame<D>::rate(double t, double dt) const {
  return 2 * std::max(std::abs(speed(t)), std::abs(speed(t + dt)));
}

template <int D>
std::function<double(const Vec3&)> RotatingFrame<D>::potential(double t) const {
  return [omega = Vec3(speed(t) * axis_), centre = centre_](const Vec3& x) {
    return 0.5 * omega.cross(x - centre).squaredNorm();
  };
}

template class RotatingFrame<2>;
template class RotatingFrame<3>;

namespace {

/// Force given by expressions. Uniform directions are gradients, and all of them if they depend on the place only and their integral
/// from the origin to each cell agrees with that from cell to cell.
template <int D>
class GivenForce final : public Force<D> {
 public:
  /// `balances`: the pressure may balance gradients. It would differ between the two sides of periodic patches.
  GivenForce(const mesh::Mesh& mesh, const std::vector<config::ExpressionText>& texts, bool balances)
      : mesh_(mesh), force_(fv::make_expressions(texts, D, "body-force")) {
    varies_ = balances && !parallel::any(mesh.comm, !mesh.neighbour_shift.empty()) &&
              std::ranges::any_of(force_, &fv::Expression::uses_space) &&
              std::ranges::none_of(force_, &fv::Expression::uses_time);
    for (int c = 0; c < D; ++c) {
      bool periodic = false;
      for (const Vec3& shift : mesh.neighbour_shift) periodic |= std::abs(shift[c]) > 1e-12 * shift.norm();
      periodic = parallel::any(mesh.comm, periodic);
      const fv::Expression& force = force_[c];
      balanced_[c] = balances && !periodic && !force.uses_space();
      if (force.uses_space() || force.uses_time() || force(Vec3::Zero(), 0) == 0) continue;
      fv::Use& use = fv::uses()["body-force"];  // a fluid that it holds at rest is loaded
      use.given = "the constant force";
      use.note(force(Vec3::Zero(), 0));
    }
  }

  /// A force that is not finite somewhere between the cells has no potential.
  void start(const Placement<D>& at) override {
    Vec<D> moment = Vec<D>::Zero();
    double volume = 0;
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      moment += at.volume[c] * at.centre[c], volume += at.volume[c];
    for (double& sum : moment) sum = parallel::sum(mesh_.comm, sum);
    origin_.template head<D>() = moment / parallel::sum(mesh_.comm, volume);
    if (!varies_) return;
    const auto place = [&](Index c) {
      Vec3 x = Vec3::Zero();
      x.template head<D>() = at.centre[c];
      return x;
    };
    double most[2] = {0, 0};  // of the difference, of the potential
    try {
      std::vector<double> potential(mesh_.cells.n_local());
      for (Index c = 0; c < mesh_.cells.n_local(); ++c) {
        potential[c] = work(origin_, place(c), 8);
        most[1] = std::max(most[1], std::abs(potential[c]));
      }
      for (Index f = 0; f < mesh_.n_interior; ++f) {
        const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
        most[0] = std::max(most[0], std::abs(potential[n] - potential[p] - work(place(p), place(n), 1)));
      }
    } catch (const Error&) {
      most[0] = std::numeric_limits<double>::infinity();
    }
    MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, mesh_.comm);
    varies_ = most[0] <= 1e-9 * most[1];
    if (varies_) balanced_.fill(true);
  }

  bool acts() const override { return !std::ranges::all_of(balanced_, std::identity()); }
  void add(double t, double dt, std::span<const Vec3> places, const Vectors<D>&,
           Vectors<D>& force) const override {
    std::vector<double> values(places.size());
    for (int c = 0; c < D; ++c) {
      if (balanced_[c]) continue;
      force_[c].evaluate(places, t + dt / 2, values);
      for (std::size_t i = 0; i < values.size(); ++i) force[i][c] += values[i];
    }
  }
  std::function<double(const Vec3&)> potential(double t) const override {
    if (std::ranges::none_of(balanced_, std::identity())) return {};
    if (varies_) return [this](const Vec3& x) { return work(origin_, x, 8); };
    Vec3 force = Vec3::Zero();
    for (int c = 0; c < D; ++c)
      if (balanced_[c]) force[c] = force_[c](Vec3::Zero(), t);
    return [force, origin = origin_](const Vec3& x) { return force.dot(x - origin); };
  }

 private:
  /// Integral of a force that varies along a line [m^2/s^2], by Lobatto's rule of order 8 on each of its parts.
  double work(const Vec3& from, const Vec3& to, int parts) const {
    const Vec3 part = (to - from) / parts;
    const double off = 0.5 * std::sqrt(3. / 7);
    double sum = 0;
    for (int k = 0; k < parts; ++k)
      for (const auto& [at, weight] : {std::pair{0., 1. / 20},
                                       {0.5 - off, 49. / 180},
                                       {0.5, 16. / 45},
                                       {0.5 + off, 49. / 180},
                                       {1., 1. / 20}})
        for (int c = 0; c < D; ++c)
          if (part[c] != 0) sum += weight * part[c] * force_[c](from + (k + at) * part, 0);
    return sum;
  }

  const mesh::Mesh& mesh_;
  std::vector<fv::Expression> force_;  // by direction [m/s^2]
  std::array<bool, D> balanced_{};     // directions in which it is a gradient
  bool varies_ = false;                // it depends on the place and is a gradient
  Vec3 origin_ = Vec3::Zero();         // where the potential is 0
};

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

/// Compressed fluid has a density that follows p itself; and blocked cells, cut ones and convective outlets see the pressure as it is.
template <int D>
std::vector<std::unique_ptr<Force<D>>> make_forces(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                                                   const FluidParameters& p) {
  std::vector<std::unique_ptr<Force<D>>> forces;
  const bool balances =
      p.bodies.empty() && p.gaps.empty() && !p.is_compressible() && !boundary.has_convective_outlet();
  if (p.rotating_frame) forces.push_back(std::make_unique<RotatingFrame<D>>(*p.rotating_frame));
  if (!p.body_force.empty()) forces.push_back(std::make_unique<GivenForce<D>>(mesh, p.body_force, balances));
  return forces;
}

template decltype(make_forces<2>) make_forces<2>;
template decltype(make_forces<3>) make_forces<3>;

/// 2-D: e_z x (u_1 - u_0) for a face of unit depth with edges along z at corner 0 (left) and 1 (right), see
/// Mesh.
template <int D>
Vec<D> turn_of(std::span<const Vec3> corners, std::span<const Vec3> velocities) {
  if constexpr (D == 2) {
    const Vec3 jump = velocities[1] - velocities[0];
    return {-jump.y(), jump.x()};
  } else {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0, last = corners.size() - 1; i < corners.size(); last = i++)
      sum += (corners[i] - corners[last]).cross(0.5 * (velocities[i] + velocities[last]));
    return sum;
  }
}

template <int D>
void set_turn(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> points,
              std::span<const Vec3> velocities, Vectors<D>& turn) {
  std::vector<Vec3> corners;
  std::size_t first = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    corners.clear();
    for (const Index v : mesh.face_points[f]) corners.push_back(points[v]);
    turn[f - mesh.n_interior] = turn_of<D>(corners, velocities.subspan(first, corners.size()));
    first += corners.size();
  }
}

std::vector<Vec3> face_corners(const mesh::Mesh& mesh, const mesh::Patch& patch,
                               std::span<const Vec3> points) {
  std::vector<Vec3> corners;
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index v : mesh.face_points[f]) corners.push_back(points[v]);
  return corners;
}

/// Adds walls with velocity given by the case; the others were added before.
template <int D>
void Boundary<D>::add_turn(const mesh::Mesh& mesh, std::span<const Vec3> points, double t,
                           Vectors<D>& turn) const {
  for (const GivenVelocity<D>& given : velocity_patches_) {
    if (!given.turns()) continue;
    const mesh::Patch& patch = given.patch();
    const std::vector<Vec3> corners = face_corners(mesh, patch, points);
    std::vector<Vec3> velocities(corners.size(), Vec3::Zero());
    Vectors<D> w(corners.size(), Vec<D>::Zero());
    given.evaluate(t, corners, w.data());
    for (std::size_t i = 0; i < w.size(); ++i) velocities[i].template head<D>() = w[i];
    set_turn<D>(mesh, patch, points, velocities, turn);
  }
}

template <int D>
void set_face_means(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> velocities,
                    Vectors<D>& w) {
  auto next = velocities.begin();
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const auto n = mesh.face_points[f].size();
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i) sum += *next++;
    w[f - mesh.n_interior] = (sum / double(n)).template head<D>();
  }
}

template <int D>
double set_body_start(const mesh::Mesh& mesh, std::span<const Vec3> points, const Boundary<D>& boundary,
                      const fv::MotionParameters& motion, double time, Vectors<D>& w, Vectors<D>& turn) {
  const fv::PrescribedMotion prescribed(motion, D);
  const double length = io::mesh_size(mesh, points);
  double largest = 0;
  for (const mesh::Patch* patch : boundary.body_patches()) {
    const std::vector<Vec3> velocities =
        prescribed.starting_velocities(face_corners(mesh, *patch, points), time, length);
    if (!turn.empty()) set_turn<D>(mesh, *patch, points, velocities, turn);
    set_face_means<D>(mesh, *patch, velocities, w);
    for (Index f = patch->first; f < patch->first + patch->count; ++f)
      largest = std::max(largest, w[f - mesh.n_interior].norm());
  }
  return parallel::max(mesh.comm, largest);
}

template Vec<2> turn_of<2>(std::span<const Vec3>, std::span<const Vec3>);
template Vec<3> turn_of<3>(std::span<const Vec3>, std::span<const Vec3>);
template decltype(set_turn<2>) set_turn<2>;
template decltype(set_turn<3>) set_turn<3>;
template void Boundary<2>::add_turn(const mesh::Mesh&, std::span<const Vec3>, double, Vectors<2>&) const;
template void Boundary<3>::add_turn(const mesh::Mesh&, std::span<const Vec3>, double, Vectors<3>&) const;
template void set_face_means<2>(const mesh::Mesh&, const mesh::Patch&, std::span<const Vec3>, Vectors<2>&);
template void set_face_means<3>(const mesh::Mesh&, const mesh::Patch&, std::span<const Vec3>, Vectors<3>&);
template decltype(set_body_start<2>) set_body_start<2>;
template decltype(set_body_start<3>) set_body_start<3>;

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
        "The mesh motion to t = {:.6g} s separates the two sides of periodic patches by {:.3g} m. Both must move identically: "
        "set 'type: periodic' for them in the mesh mover as well; a 'motion' must be periodic from side to side, which a "
        "rotation of the whole mesh is not.",
        time, gap);
}

template class MeshPath<2>;
template class MeshPath<3>;

}  // namespace couplet::fluid
