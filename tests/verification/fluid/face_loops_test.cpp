// SPDX-License-Identifier: Apache-2.0
// The face loops one by one, on cells that are oblique and skew: what a linear velocity makes of them is known exactly.
#include "fluid_case.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/step/fractional_step.hpp"

namespace couplet::fluid::test::face_loops_test {
using namespace mesh;

/// A sheared box of perturbed cells, every side a wall of given velocity, in a linear flow u = a + G x.
template <int D>
struct LinearFlow {
  explicit LinearFlow(BoxCells cells)
      : loaded(distribute(MPI_COMM_WORLD, sheared(cells))),
        boundary_(mesh, geometry, walls()),
        at(make_placement<D>(mesh, geometry)) {
    slope << Tensor<D>::NullaryExpr(
        [](Eigen::Index i, Eigen::Index j) { return 0.3 + 0.7 * double(i) - 1.1 * double(j * i); });
    slope(0, 0) -= slope.trace();
    for (Index c = 0; c < mesh.cells.n_local(); ++c) u.push_back(velocity(at->centre[c]));
    for (const Vec3& x : at->boundary_centre) u_boundary.push_back(velocity(x.template head<D>()));
  }
  static RawMesh sheared(BoxCells cells) {
    RawMesh raw = make_box(cells, {6, 5, 4}, Vec3::Zero(), Vec3(1, 1, D == 3 ? 1 : 0));
    perturb_interior(raw, 0.2, 3);
    for (Vec3& x : raw.points) x.x() += 0.6 * x.y();
    return raw;
  }
  static FluidParameters walls() {
    FluidParameters p = fluid_of(1.3, 0.4);
    all_sides(p, D, boundary(BoundaryType::moving_wall, std::vector<std::string>(D, "0")));
    return p;
  }
  Vec<D> velocity(const Vec<D>& x) const { return Vec<D>::LinSpaced(0.2, 0.9) + slope * x; }
  /// Whether all faces of a cell are interior.
  std::vector<char> inner() const {
    std::vector<char> is_inner(mesh.cells.n_local(), 1);
    for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) is_inner[mesh.owner[f]] = 0;
    return is_inner;
  }
  const LoadedMesh loaded;
  const Mesh& mesh = loaded.mesh;
  const Geometry& geometry = loaded.geometry;
  const Boundary<D> boundary_;
  const std::shared_ptr<const Placement<D>> at;
  Tensor<D> slope = Tensor<D>::Zero();
  Vectors<D> u, u_boundary;
};

template <int D>
void check_friction(BoxCells cells) {
  const LinearFlow<D> flow(cells);
  ASSERT_FALSE(flow.at->oblique.empty());
  State<D> s;
  s.placement = flow.at, s.u = flow.u, s.u_boundary = flow.u_boundary;
  s.phi.assign(flow.mesh.n_flux_faces(), 0);
  RateOperator<D> rates(flow.mesh, flow.boundary_, 0.4);
  Rates<D> oblique, orthogonal, split;
  rates.apply(s, false, true, oblique);
  rates.apply(s, false, false, orthogonal);
  rates.apply(s, true, true, split);
  double without = 0;
  for (Index c = 0; c < flow.mesh.cells.n_owned(); ++c) {
    EXPECT_LT(oblique.rate[c].norm(), 1e-12);
    EXPECT_LT(split.viscous[c].norm(), 1e-12);
    without = std::max(without, orthogonal.rate[c].norm());
  }
  EXPECT_GT(parallel::max(MPI_COMM_WORLD, without), 1e-3) << "the oblique part counts on this mesh";
}

// nu grad u . S over all faces of a cell is none where grad u is the same everywhere.
TEST(FaceLoops, friction_of_a_linear_flow_is_none_on_oblique_quadrilaterals) {
  check_friction<2>(BoxCells::quadrilaterals);
}
TEST(FaceLoops, friction_of_a_linear_flow_is_none_on_oblique_triangles) {
  check_friction<2>(BoxCells::triangles);
}
TEST(FaceLoops, friction_of_a_linear_flow_is_none_on_oblique_tetrahedra) {
  check_friction<3>(BoxCells::tetrahedra);
}

template <int D>
void check_eddies(BoxCells cells) {
  const LinearFlow<D> flow(cells);
  State<D> s;
  s.placement = flow.at, s.u = flow.u, s.u_boundary = flow.u_boundary;
  s.phi.assign(flow.mesh.n_flux_faces(), 0);
  s.eddy.assign(flow.mesh.cells.n_local(), 0.7);
  FluidParameters p;
  p.turbulence.emplace();
  RateOperator<D> rates(flow.mesh, flow.boundary_, 0.0, make_momentum_terms<D>(flow.mesh, flow.boundary_, p));
  Rates<D> got;
  rates.apply(s, false, true, got);
  const std::vector<char> inner = flow.inner();
  for (Index c = 0; c < flow.mesh.cells.n_owned(); ++c) EXPECT_LT(inner[c] ? got.rate[c].norm() : 0, 1e-12);
  for (Index f = 0; f < flow.mesh.n_interior; ++f) {
    std::vector<Tensor<D>> gradient(flow.mesh.cells.n_local(), flow.slope);
    const Vec<D> stress =
        eddy_stress<D>(*flow.at, s.eddy, s.u, gradient, f, flow.mesh.owner[f], flow.mesh.neighbour[f]);
    EXPECT_LT((stress - 0.7 * (flow.slope + flow.slope.transpose()) * flow.at->area[f]).norm(), 1e-12);
  }
}

TEST(FaceLoops, stress_of_eddies_in_a_linear_flow_is_exact_on_oblique_cells) {
  check_eddies<2>(BoxCells::quadrilaterals);
  check_eddies<3>(BoxCells::tetrahedra);
}

template <int D>
void check_flux(BoxCells cells) {
  const LinearFlow<D> flow(cells);
  ASSERT_TRUE(flow.at->skewed());
  std::vector<Tensor<D>> gradient;
  std::vector<double> flux(flow.mesh.n_interior);
  mean_flux<D>(flow.mesh, *flow.at, flow.u, flow.u_boundary, gradient, flux);
  for (Index c = 0; c < flow.mesh.cells.n_local(); ++c) EXPECT_LT((gradient[c] - flow.slope).norm(), 1e-11);
  double skew = 0;
  for (Index f = 0; f < flow.mesh.n_interior; ++f) {
    const Vec<D> centre = flow.geometry.face_centre[f].template head<D>();
    EXPECT_NEAR(flux[f], flow.velocity(centre).dot(flow.at->area[f]), 1e-13);
    const Vec<D> middle = 0.5 * (flow.u[flow.mesh.owner[f]] + flow.u[flow.mesh.neighbour[f]]);
    skew = std::max(skew, std::abs(flux[f] - middle.dot(flow.at->area[f])));
  }
  EXPECT_GT(parallel::max(MPI_COMM_WORLD, skew), 1e-3)
      << "the carrying on to the face's centre counts on this mesh";
}

TEST(FaceLoops, flux_of_a_linear_flow_is_exact_on_skew_cells) {
  check_flux<2>(BoxCells::quadrilaterals);
  check_flux<2>(BoxCells::triangles);
  check_flux<3>(BoxCells::tetrahedra);
}

/// What a fractional step gives to the loads: a pressure that is linear in space, faces that move.
template <int D>
struct Loaded {
  explicit Loaded(BoxCells cells)
      : flow(cells),
        parameters(LinearFlow<D>::walls()),
        scene{flow.mesh, flow.geometry.points, flow.boundary_, parameters, parameters.properties()} {
    for (std::size_t i = 0; i < flow.geometry.points.size(); ++i) {
      const Vec3& x = flow.geometry.points[i];
      after.push_back(x + 0.1 * Vec3(x.x() * x.y(), 0.5 * x.x() - x.y(), D == 3 ? 0.3 * x.x() * x.z() : 0));
    }
    from.placement = flow.at;
    step.dt = 0.01;
    step.to = make_placement<D>(flow.mesh, after);
    projected.w.assign(flow.u_boundary.size(), Vec<D>::Zero());
    prediction.w = prediction.viscous_flux = projected.w;
  }
  void set_pressure(double level, const Vec<D>& slope) {
    projected.boundary.clear();
    for (const Vec3& x : step.to->boundary_centre)
      projected.boundary.push_back(level + slope.dot(x.template head<D>()));
  }
  LinearFlow<D> flow;
  FluidParameters parameters;
  std::vector<Vec3> after;
  Scene<D> scene;
  FluidStep<D> step;
  Prediction<D> prediction;
  Projected<D> projected;
  Loads<D> loads;
  State<D> from;
};

// p dV: the work of a uniform pressure on a wall that turns and stretches within the step is that on the volume, which takes the
// area half way.
TEST(FaceLoops, load_of_a_uniform_pressure_works_by_the_volume_that_its_walls_sweep) {
  Loaded<2> c(BoxCells::quadrilaterals);
  c.set_pressure(250, Vec<2>::Zero());
  c.loads.set(c.scene, c.step, c.prediction, c.projected, c.from);
  double done = 0, volume = 0;
  for (std::size_t b = 0; b < c.projected.w.size(); ++b) {
    const Index f = c.flow.mesh.n_interior + Index(b);
    Vec3 moved = Vec3::Zero();
    for (const Index v : c.flow.mesh.face_points[f]) moved += (c.after[v] - c.flow.geometry.points[v]) / 2;
    done += c.loads.pressure[b].dot(moved.head<2>());
  }
  for (Index k = 0; k < c.flow.mesh.cells.n_owned(); ++k)
    volume += c.step.to->volume[k] - c.flow.at->volume[k];
  done = parallel::sum(MPI_COMM_WORLD, done), volume = parallel::sum(MPI_COMM_WORLD, volume);
  EXPECT_GT(std::abs(volume), 0.02);
  EXPECT_NEAR(done, 250 * volume, 1e-10);
}

template <int D>
void check_linear_pressure(BoxCells cells) {
  Loaded<D> c(cells);
  const Vec<D> slope = Vec<D>::LinSpaced(30, -70);
  c.set_pressure(250, slope);
  c.loads.set(c.scene, c.step, c.prediction, c.projected, c.from);
  for (std::size_t b = 0; b < c.projected.w.size(); ++b) {
    const Index f = c.flow.mesh.n_interior + Index(b);
    const double p = 250 + slope.dot(c.step.to->boundary_centre[b].template head<D>());
    const Vec<D> wanted = p * (c.flow.at->area[f] + c.step.to->area[f]) / 2;
    EXPECT_LT((c.loads.pressure[b] - wanted).norm(), 1e-9 * wanted.norm());
  }
}

TEST(FaceLoops, load_of_a_linear_pressure_is_exact_on_every_wall) {
  check_linear_pressure<2>(BoxCells::quadrilaterals);
  check_linear_pressure<3>(BoxCells::hexahedra);
}

// mu g (u_P - u_b), its normal part with the pressure; what the wall then does beyond the guess counts with the weight of t^{n+1}.
TEST(FaceLoops, load_is_the_momentum_flux_and_follows_the_velocity_of_the_wall) {
  Loaded<2> c(BoxCells::quadrilaterals);
  FluidParameters sliding = LinearFlow<2>::walls();
  all_sides(sliding, 2, boundary(BoundaryType::interface));
  const Boundary<2> given(c.flow.mesh, c.flow.geometry, sliding);
  const Scene<2> scene{c.flow.mesh, c.flow.geometry.points, given, sliding, sliding.properties()};
  const Vec<2> guess(0.3, -0.2), later(0.5, 0.4);
  Vectors<2>& predicted = c.prediction.viscous_flux;
  wall_flux<2>(c.flow.mesh, *c.step.to, 0.4, c.flow.u, Vectors<2>(c.flow.u_boundary.size(), guess),
               predicted);
  for (std::size_t b = 0; b < predicted.size(); ++b) {
    const Index f = c.flow.mesh.n_interior + Index(b);
    const Vec<2> slip = c.flow.u[c.flow.mesh.owner[f]] - guess;
    EXPECT_LT((predicted[b] - 0.4 * c.step.to->conductance[f] * slip).norm(), 1e-12);
  }
  c.projected.boundary.assign(predicted.size(), 250);
  c.prediction.w.assign(predicted.size(), guess);
  c.projected.w.assign(predicted.size(), later);
  for (const double weight : {0., 0.5, 0.5625}) {
    c.prediction.weight = weight;
    c.loads.set(scene, c.step, c.prediction, c.projected, c.from);
    for (std::size_t b = 0; b < predicted.size(); ++b) {
      const Index f = c.flow.mesh.n_interior + Index(b);
      const Vec<2> n = c.step.to->area[f].normalized(), c_ = later - guess;
      const Vec<2> wanted =
          predicted[b] - weight * 0.4 * c.step.to->conductance[f] * (c_ + 3 * c_.dot(n) * n);
      const Vec<2> pressure = 125 * (c.flow.at->area[f] + c.step.to->area[f]);
      EXPECT_LT((c.loads.viscous[b] + c.loads.pressure[b] - pressure - wanted).norm(), 1e-11);
      EXPECT_NEAR(c.loads.viscous[b].dot(n), 0, 1e-12);
    }
  }
}

}  // namespace couplet::fluid::test::face_loops_test
