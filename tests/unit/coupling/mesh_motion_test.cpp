// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/mesh_motion.hpp"

#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::mesh_motion_test {
using namespace coupling;
using namespace mesh;

/// The world as two programs: the mover on rank 0 (or on the last two of five), the fluid on the others.
class TwoPrograms : public ::testing::Test {
 protected:
  TwoPrograms() {
    const int size = parallel::comm_size(MPI_COMM_WORLD), rank = parallel::comm_rank(MPI_COMM_WORLD);
    const int n_mover = size == 5 ? 2 : 1;
    is_mover = rank < n_mover;
    MPI_Comm_split(MPI_COMM_WORLD, is_mover ? 0 : 1, rank, &own);
    MPI_Intercomm_create(own, 0, MPI_COMM_WORLD, is_mover ? n_mover : 0, 17, &peers);
  }
  ~TwoPrograms() override {
    MPI_Comm_free(&peers);
    MPI_Comm_free(&own);
  }
  std::string set_up_error(const Mesh& mesh, const Geometry& geometry) const {
    return support::error_of([&] {
      if (is_mover)
        MeshMotionSink(peers, mesh, geometry.points);
      else
        make_mesh_motion_source(peers, mesh, geometry.points);
    });
  }
  bool is_mover = false;
  MPI_Comm own = MPI_COMM_NULL, peers = MPI_COMM_NULL;
};

double motion(GlobalIndex point, int component, int step) {
  return std::sin(double(point) + 10 * component + 100 * step);
}

class MeshMotion : public TwoPrograms, public ::testing::WithParamInterface<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Boxes, MeshMotion, ::testing::Values(BoxCells::triangles, BoxCells::mixed),
                         [](const auto& info) {
                           return info.param == BoxCells::mixed ? "mixed" : "triangles";
                         });

TEST_P(MeshMotion, every_local_point_of_the_fluid_gets_its_own_displacement) {
  const auto [mesh, geometry] = distribute(own, make_box(GetParam(), {5, 4, 3}, Vec3::Zero(), Vec3::Ones()));
  const auto expected = [&](int step) {
    std::vector<double> values;
    for (const GlobalIndex p : mesh.point_id)
      for (int c = 0; c < mesh.dim; ++c) values.push_back(motion(p, c, step));
    return values;
  };
  if (is_mover) {
    MeshMotionSink sink(peers, mesh, geometry.points);
    for (int step = 0; step < 3; ++step) sink.send(expected(step));
    sink.send(expected(3), expected(4));
  } else {
    const auto source = make_mesh_motion_source(peers, mesh, geometry.points);
    for (int step = 0; step < 3; ++step) EXPECT_EQ(source->receive(), expected(step)) << "step " << step;
    EXPECT_TRUE(source->velocity().empty());
    EXPECT_EQ(source->receive(), expected(3));
    EXPECT_EQ(source->velocity(), expected(4));
  }
}

TEST_F(TwoPrograms, failure_of_the_mover_is_a_failed_step_for_the_fluid_and_the_next_motion_arrives) {
  const auto [mesh, geometry] =
      distribute(own, make_box(BoxCells::hexahedra, {3, 3, 3}, Vec3::Zero(), Vec3::Ones()));
  const std::vector<double> ones(3 * std::size_t(mesh.points.n_local()), 1.0);
  if (is_mover) {
    MeshMotionSink sink(peers, mesh, geometry.points);
    sink.send_failure();
    sink.send(ones);
  } else {
    const auto source = make_mesh_motion_source(peers, mesh, geometry.points);
    EXPECT_THROW(source->receive(), SolveFailure);
    EXPECT_EQ(source->receive(), ones);
  }
}

TEST_F(TwoPrograms, large_motion_is_sent_without_waiting_for_the_fluid) {
  // Larger than what MPI buffers: the mover must get on although the fluid takes it later.
  const auto [mesh, geometry] =
      distribute(own, make_box(BoxCells::quadrilaterals, {200, 100, 0}, Vec3::Zero(), Vec3::Ones()));
  const std::vector<double> ones(2 * std::size_t(mesh.points.n_local()), 1.0);
  if (is_mover) {
    MeshMotionSink sink(peers, mesh, geometry.points);
    sink.send(ones);
    MPI_Barrier(MPI_COMM_WORLD);
    sink.send_failure();
  } else {
    const auto source = make_mesh_motion_source(peers, mesh, geometry.points);
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_EQ(source->receive(), ones);
    EXPECT_THROW(source->receive(), SolveFailure);
  }
}

TEST_F(TwoPrograms, meshes_with_other_numbers_of_points_are_refused_on_both_sides) {
  const int n = is_mover ? 3 : 4;
  const auto [mesh, geometry] =
      distribute(own, make_box(BoxCells::quadrilaterals, {n, 3, 0}, Vec3::Zero(), Vec3::Ones()));
  EXPECT_EQ(
      set_up_error(mesh, geometry),
      fmt::format(
          "The meshes of the fluid and the mesh mover differ: {} points in 2-D on this side, {} points in "
          "2-D on the other. Both participants must read the same mesh file.",
          is_mover ? 16 : 20, is_mover ? 20 : 16));
}

TEST_F(TwoPrograms, meshes_with_other_places_of_the_points_are_refused_on_both_sides) {
  const auto [mesh, geometry] = distribute(
      own, make_box(BoxCells::quadrilaterals, {3, 3, 0}, Vec3::Zero(), Vec3(is_mover ? 1.001 : 1, 1, 0)));
  EXPECT_THAT(set_up_error(mesh, geometry),
              ::testing::HasSubstr("mesh mover differ: their points have different coordinates."));
}

}  // namespace couplet::mesh_motion_test
