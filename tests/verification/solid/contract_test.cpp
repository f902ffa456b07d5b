// SPDX-License-Identifier: Apache-2.0
// What the participant contract asks of the solid, on 1, 2 and 3 ranks.
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::contract_test {
using namespace coupling;
using namespace mesh;

RawMesh flap_mesh(BoxCells cells) {
  RawMesh raw = make_box(cells, {3, 8, 2}, Vec3::Zero(), Vec3(0.1, 1, dimension_of(cells) == 3 ? 0.05 : 0));
  perturb_interior(raw, 0.15, 3);
  return raw;
}

/// Clamped at ymin, wetted on three sides.
SolidParameters flap_parameters(int dim) {
  SolidParameters p = box_parameters(dim);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {3000, 4e6, 0.3};
  p.method.relative_tolerance = 1e-12;
  p.boundaries["ymin"] = clamped(dim);
  for (const char* name : {"xmin", "xmax", "ymax"}) p.boundaries[name] = boundary(Type::interface_);
  return p;
}

std::unique_ptr<Solid> make_flap(const LoadedMesh& body) {
  return std::make_unique<Solid>(body, flap_parameters(body.mesh.dim), SolidContext{});
}

std::unique_ptr<Solid> make_flap(BoxCells cells, MPI_Comm comm = MPI_COMM_WORLD) {
  return make_flap(distribute(comm, flap_mesh(cells)));
}

/// A load that is 5 Pa from the left, split between the two data.
Exchange load_on(const Interface& interface, double factor) {
  Exchange in;
  for (std::size_t f = 0; f < interface.face_areas.size(); ++f)
    for (int a = 0; a < interface.dim; ++a) {
      const double force = interface.face_centres[f][0] < 1e-9 && a == 0 ? interface.face_areas[f].norm() : 0;
      in["pressure-force"].push_back(4 * factor * force);
      in["viscous-force"].push_back(1 * factor * force);
    }
  return in;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0, size = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(a[i]));
  }
  return size > 0 ? largest / size : largest;
}

class SolidContract : public ::testing::TestWithParam<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Solid, SolidContract,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::mixed));

TEST_P(SolidContract, solve_starts_from_the_accepted_state_each_time) {
  const auto solid = make_flap(GetParam());
  const Interface interface = solid->initialise();
  const Exchange one = load_on(interface, 1), other = load_on(interface, -3);
  solid->begin_step({0, 0.01, Scheme::implicit, 0});
  solid->solve(one);
  solid->accept_step();
  const std::vector<double> before = solid->stepper().state().cell_u;
  solid->begin_step({0.01, 0.01, Scheme::implicit, 1});
  const Exchange first = solid->solve(one);
  solid->solve(other);
  EXPECT_LT(difference(first.at("displacement"), solid->solve(one).at("displacement")), 1e-13);
  solid->begin_step({0.01, 0.005, Scheme::implicit, 1});
  solid->solve(other);
  solid->begin_step({0.01, 0.01, Scheme::implicit, 1});
  const Exchange again = solid->solve(one);
  EXPECT_LT(difference(first.at("displacement"), again.at("displacement")), 1e-13);
  EXPECT_LT(difference(first.at("velocity"), again.at("velocity")), 1e-13);
  EXPECT_EQ(before, solid->stepper().state().cell_u);
}

TEST_P(SolidContract, interface_load_acts_as_the_same_traction) {
  const LoadedMesh body = distribute(MPI_COMM_WORLD, flap_mesh(GetParam()));
  const auto coupled = make_flap(body);
  const Interface interface = coupled->initialise();
  SolidParameters p = flap_parameters(dimension_of(GetParam()));
  std::vector<std::string> traction(p.dimension, "0");
  traction[0] = "5";
  p.boundaries["xmin"] = boundary(Type::traction, traction);
  Solid alone(body, p, SolidContext{});
  alone.initialise();
  for (int i = 0; i < 3; ++i) {
    coupled->begin_step({0.01 * i, 0.01, Scheme::implicit, i});
    coupled->solve(load_on(interface, 1));
    coupled->accept_step();
    step(alone, 0.01);
  }
  EXPECT_LT(difference(coupled->stepper().state().cell_u, alone.stepper().state().cell_u), 1e-12);
  EXPECT_NEAR(coupled->fields().total_load()[0], 5 * (p.dimension == 3 ? 0.05 : 1), 1e-12);
}

TEST_P(SolidContract, interface_values_are_those_of_the_vertices) {
  const auto solid = make_flap(GetParam());
  const Interface interface = solid->initialise();
  solid->begin_step({0, 0.01, Scheme::implicit, 0});
  const Exchange out = solid->solve(load_on(interface, 1));
  solid->accept_step();
  // Each rank gives the values of its own vertices.
  ASSERT_EQ(out.at("displacement").size(), interface.vertices.size() * interface.dim);
  ASSERT_EQ(out.at("velocity").size(), interface.vertices.size() * interface.dim);
  for (std::size_t i = 0; i < interface.vertices.size(); ++i)
    if (interface.vertices[i][1] < 1e-9) {
      EXPECT_EQ(out.at("displacement")[i * interface.dim], 0);
    }
  // The vertices at the top move with the load; all ranks look at their own points.
  const std::vector<double> points = solid->fields().point_displacement();
  double top = 0;
  for (Index v = 0; v < solid->body().mesh().points.n_local(); ++v)
    if (solid->body().geometry().points[v][1] > 1 - 1e-9)
      top = std::max(top, points[std::size_t(v) * interface.dim]);
  double sent = 0;
  for (std::size_t i = 0; i < interface.vertices.size(); ++i)
    if (interface.vertices[i][1] > 1 - 1e-9) sent = std::max(sent, out.at("displacement")[i * interface.dim]);
  EXPECT_NEAR(parallel::max(MPI_COMM_WORLD, sent), parallel::max(MPI_COMM_WORLD, top), 1e-15);
  EXPECT_GT(parallel::max(MPI_COMM_WORLD, top), 0);
}

TEST_P(SolidContract, all_ranks_together_give_what_one_rank_gives) {
  const auto together = make_flap(GetParam());
  const auto alone = make_flap(GetParam(), MPI_COMM_SELF);
  const Interface there = together->initialise(), here = alone->initialise();
  Exchange out, expected;
  for (int i = 0; i < 5; ++i) {
    together->begin_step({0.01 * i, 0.01, Scheme::implicit, i});
    alone->begin_step({0.01 * i, 0.01, Scheme::implicit, i});
    out = together->solve(load_on(there, 1 + i));
    expected = alone->solve(load_on(here, 1 + i));
    together->accept_step();
    alone->accept_step();
  }
  std::map<GlobalIndex, Index> cell_of;
  for (Index c = 0; c < alone->body().mesh().cells.n_owned(); ++c)
    cell_of[alone->body().mesh().cell_id[c]] = c;
  const int dim = alone->body().mesh().dim;
  std::vector<double> mine, theirs;
  for (Index c = 0; c < together->body().mesh().cells.n_local(); ++c)
    for (int a = 0; a < dim; ++a) {
      mine.push_back(together->stepper().state().cell_u[std::size_t(c) * dim + a]);
      theirs.push_back(alone->stepper()
                           .state()
                           .cell_u[std::size_t(cell_of.at(together->body().mesh().cell_id[c])) * dim + a]);
    }
  EXPECT_LT(difference(mine, theirs), 1e-10);
  // Each vertex of the whole interface is given by one rank, with the value that one rank alone gives it.
  std::map<std::array<double, 3>, std::size_t> vertex_of;
  for (std::size_t i = 0; i < here.vertices.size(); ++i)
    vertex_of[{here.vertices[i][0], here.vertices[i][1], here.vertices[i][2]}] = i;
  EXPECT_EQ(parallel::sum(MPI_COMM_WORLD, GlobalIndex(there.vertices.size())),
            GlobalIndex(here.vertices.size()));
  for (const char* name : {"displacement", "velocity"}) {
    std::vector<double> given, wanted;
    for (std::size_t i = 0; i < there.vertices.size(); ++i) {
      const Vec3& x = there.vertices[i];
      for (int a = 0; a < dim; ++a) {
        given.push_back(out.at(name)[i * dim + a]);
        wanted.push_back(expected.at(name)[vertex_of.at({x[0], x[1], x[2]}) * dim + a]);
      }
    }
    EXPECT_LT(difference(given, wanted), 1e-10) << name;
  }
}

void expect_that_a_checkpoint_continues_bit_for_bit(BoxCells cells, MethodParameters method) {
  const LoadedMesh body = distribute(MPI_COMM_WORLD, flap_mesh(cells));
  SolidParameters parameters = flap_parameters(body.mesh.dim);
  parameters.method = method;
  const auto make = [&] { return std::make_unique<Solid>(body, parameters, SolidContext{}); };
  const auto advance = [&](Solid& solid, int from, int end, bool then_ends) {
    const Interface interface = solid.initialise();
    Exchange out;
    for (int i = from; i < end; ++i) {
      solid.begin_step({.time = 0.01 * i,
                        .dt = 0.01,
                        .scheme = Scheme::implicit,
                        .number = i,
                        .is_last = then_ends && i + 1 == end});
      out = solid.solve(load_on(interface, 1 + i));
      solid.accept_step();
    }
    return out;
  };
  const auto whole = make(), begun = make(), continued = make();
  const Exchange of_whole = advance(*whole, 0, 6, false);
  advance(*begun, 0, 3, true);
  support::SavedState(*begun).load_into(*continued);
  EXPECT_EQ(of_whole, advance(*continued, 3, 6, true));
  EXPECT_EQ(whole->stepper().state().cell_v, continued->stepper().state().cell_v);
}

TEST_P(SolidContract, a_loaded_checkpoint_continues_bit_for_bit) {
  expect_that_a_checkpoint_continues_bit_for_bit(GetParam(), {});
}

TEST_P(SolidContract, a_loaded_checkpoint_continues_with_the_same_first_guesses) {
  MethodParameters method;
  method.type = MethodParameters::Type::newton_krylov;
  method.preconditioner = MethodParameters::Preconditioner::multigrid;
  method.relative_tolerance = 1e-4;
  method.corrections_kept = 2;
  expect_that_a_checkpoint_continues_bit_for_bit(GetParam(), method);
}

TEST_P(SolidContract, a_step_that_cannot_be_solved_fails_on_all_ranks_and_leaves_the_state) {
  const auto solid = make_flap(GetParam());
  const Interface interface = solid->initialise();
  solid->begin_step({0, 0.01, Scheme::implicit, 0});
  const Exchange first = solid->solve(load_on(interface, 1));
  EXPECT_THROW(solid->solve(load_on(interface, std::nan(""))), SolveFailure);
  EXPECT_EQ(solid->stepper().state().steps, 0);
  const Exchange again = solid->solve(load_on(interface, 1));
  EXPECT_LT(difference(first.at("displacement"), again.at("displacement")), 1e-13);
}

TEST(SolidInterface, data_it_does_not_know_are_refused_by_name) {
  const auto solid = make_flap(BoxCells::quadrilaterals);
  solid->initialise();
  solid->begin_step({0, 0.01, Scheme::implicit, 0});
  EXPECT_THAT(
      [&] {
        solid->solve({{"temperature", {}}});
      },
      ::testing::ThrowsMessage<Error>(::testing::HasSubstr("The solid received 'temperature'")));
}

}  // namespace couplet::testing::contract_test
