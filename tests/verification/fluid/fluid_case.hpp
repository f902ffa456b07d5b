// SPDX-License-Identifier: Apache-2.0
// A fluid in a box for the tests: mesh, parameters, prescribed motion of points and walls, errors against
// fields.
#pragma once

#include "common/mesh/load.hpp"
#include "fluid_solver/step/fluid.hpp"
#include "tests/support/test.hpp"

namespace couplet::fluid::test {
using PointMotion = std::function<Vec3(const Vec3& reference, GlobalIndex id, double t)>;
using WallVelocity = std::function<Vec3(const Vec3& face_centre, double t)>;

inline BoundaryParameters boundary(BoundaryType type, std::vector<std::string> velocity = {},
                                   const std::string& pressure = "0") {
  BoundaryParameters b;
  b.type = type;
  for (const std::string& text : velocity) b.velocity.push_back({text});
  b.pressure.text = pressure;
  return b;
}

/// With the mesh's name as a participant in 2-D.
inline FluidParameters fluid_of(double density, double viscosity,
                                double pressure_tolerance = FluidParameters{}.pressure_tolerance,
                                const char* mesh = nullptr) {
  FluidParameters p;
  if (mesh) p.mesh = mesh, p.dimension = 2;
  p.density = density;
  p.viscosity = viscosity;
  p.pressure_tolerance = pressure_tolerance;
  return p;
}

inline void all_sides(FluidParameters& p, int dim, const BoundaryParameters& b) {
  for (const char* side : {"xmin", "xmax", "ymin", "ymax"}) p.boundaries[side] = b;
  if (dim == 3)
    for (const char* side : {"zmin", "zmax"}) p.boundaries[side] = b;
}

template <int D>
class FluidCase {
 public:
  FluidCase(MPI_Comm comm, const mesh::RawMesh& raw, FluidParameters parameters, PointMotion motion = {})
      : loaded_(std::make_unique<mesh::LoadedMesh>(mesh::distribute(comm, raw))), motion_(std::move(motion)) {
    parameters.dimension = D;
    fluid_ = std::make_unique<Fluid<D>>(mesh(), geometry(), parameters, bool(motion_));
  }

  std::vector<Vec3> points(double t) const {
    std::vector<Vec3> moved;
    if (!motion_) return moved;
    for (std::size_t i = 0; i < geometry().points.size(); ++i)
      moved.push_back(motion_(geometry().points[i], mesh().point_id[i], t));
    return moved;
  }
  Vectors<D> wall(const WallVelocity& w, double t) const {
    Vectors<D> values(mesh().boundary.n_owned(), Vec<D>::Zero());
    if (!w) return values;
    for (std::size_t b = 0; b < values.size(); ++b)
      values[b] = w(fluid_->state().placement->boundary_centre[b], t).template head<D>();
    return values;
  }
  void step(double dt, const WallVelocity& w = {}) {
    const double t = fluid_->state().time;
    fluid_->begin_step(t, dt);
    fluid_->solve(points(t + dt), wall(w, t + dt));
    fluid_->accept();
  }
  void run(double end, int steps, const WallVelocity& w = {}) {
    const double begin = fluid_->state().time;
    for (int i = 0; i < steps; ++i) step((end - begin) / steps, w);
  }

  /// Volume-weighted root mean square of u - exact, and the largest.
  double velocity_error(const std::function<Vec3(const Vec3&)>& exact) const {
    const State<D>& s = fluid_->state();
    double square = 0, volume = 0;
    for (Index c = 0; c < mesh().cells.n_owned(); ++c) {
      Vec3 x = Vec3::Zero();
      x.head<D>() = s.placement->centre[c];
      square += s.placement->volume[c] * (s.u[c] - exact(x).template head<D>()).squaredNorm();
      volume += s.placement->volume[c];
    }
    return std::sqrt(parallel::sum(mesh().comm, square) / parallel::sum(mesh().comm, volume));
  }
  double largest_velocity_error(const std::function<Vec3(const Vec3&)>& exact) const {
    const State<D>& s = fluid_->state();
    double largest = 0;
    for (Index c = 0; c < mesh().cells.n_owned(); ++c) {
      Vec3 x = Vec3::Zero();
      x.head<D>() = s.placement->centre[c];
      largest = std::max(largest, (s.u[c] - exact(x).template head<D>()).norm());
    }
    return parallel::max(mesh().comm, largest);
  }
  /// Root mean square of p - exact after both lost their means.
  double pressure_error(const std::function<double(const Vec3&)>& exact) const {
    const State<D>& s = fluid_->state();
    double mean = 0, square = 0, volume = 0;
    std::vector<double> difference(mesh().cells.n_owned());
    for (Index c = 0; c < mesh().cells.n_owned(); ++c) {
      Vec3 x = Vec3::Zero();
      x.head<D>() = s.placement->centre[c];
      difference[c] = fluid_->pressure()->p[c] - exact(x);
      mean += s.placement->volume[c] * difference[c];
      volume += s.placement->volume[c];
    }
    volume = parallel::sum(mesh().comm, volume);
    mean = parallel::sum(mesh().comm, mean) / volume;
    for (Index c = 0; c < mesh().cells.n_owned(); ++c)
      square += s.placement->volume[c] * std::pow(difference[c] - mean, 2);
    return std::sqrt(parallel::sum(mesh().comm, square) / volume);
  }

  Fluid<D>& fluid() { return *fluid_; }
  const State<D>& state() const { return fluid_->state(); }
  const mesh::Mesh& mesh() const { return loaded_->mesh; }
  const mesh::Geometry& geometry() const { return loaded_->geometry; }

 private:
  std::unique_ptr<mesh::LoadedMesh> loaded_;
  PointMotion motion_;
  std::unique_ptr<Fluid<D>> fluid_;
};

/// Root mean square of the difference of two states on the same mesh.
template <int D>
double difference(const FluidCase<D>& a, const FluidCase<D>& b) {
  double square = 0, volume = 0;
  for (Index c = 0; c < a.mesh().cells.n_owned(); ++c) {
    const double v = a.state().placement->volume[c];
    square += v * (a.state().u[c] - b.state().u[c]).squaredNorm();
    volume += v;
  }
  return std::sqrt(parallel::sum(a.mesh().comm, square) / parallel::sum(a.mesh().comm, volume));
}

/// A channel whose floor moves: inlet left, outlet right, slip lid.
inline FluidParameters channel(ViscousTreatment viscous = ViscousTreatment::automatic,
                               double pressure_tolerance = 1e-12) {
  FluidParameters p;
  p.density = 1.3;
  p.viscosity = 0.05;
  p.viscous = viscous;
  p.pressure_tolerance = pressure_tolerance;
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"4*y*(1-y)*(1+0.3*sin(5*t))", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.boundaries["ymax"] = boundary(BoundaryType::slip);
  p.boundaries["ymin"] = boundary(BoundaryType::interface);
  return p;
}

inline mesh::RawMesh channel_mesh() {
  mesh::RawMesh raw =
      mesh::make_box(mesh::BoxCells::quadrilaterals, {24, 12, 1}, Vec3::Zero(), Vec3(2, 1, 1));
  mesh::perturb_interior(raw, 0.15, 7);
  return raw;
}

}  // namespace couplet::fluid::test
