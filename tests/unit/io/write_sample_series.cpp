// SPDX-License-Identifier: Apache-2.0
// Writes FOLDER/<kind>.xdmf for every kind of mesh: four times 0.0, 0.1, ...; the points move by x += t * y.
// Point field "displacement", cell fields "pressure" (linear in x + t) and "velocity" (cell centre).
#include <mpi.h>

#include <limits>

#include "common/io/fields/field_writer.hpp"
#include "common/linalg/petsc.hpp"
#include "common/mesh/load.hpp"
#include "common/parallel/collective.hpp"

namespace {

using namespace couplet;

void write_series(const std::string& folder, const std::string& name, mesh::BoxCells cells) {
  const bool flat = cells == mesh::BoxCells::quadrilaterals || cells == mesh::BoxCells::triangles;
  mesh::RawMesh raw;
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0)
    raw = mesh::make_box(cells, {6, 4, flat ? 1 : 2}, Vec3::Zero(), Vec3(2, 1, flat ? 0 : 1));
  const auto [mesh, geometry] = mesh::distribute(MPI_COMM_WORLD, raw);
  io::FieldWriter writer(mesh, geometry.points, folder, name, true, std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < 4; ++i) {
    const double time = 0.1 * i;
    std::vector<Vec3> points = geometry.points;
    std::vector<double> displacement, pressure, velocity;
    for (Vec3& x : points) {
      displacement.push_back(time * x[1]);
      displacement.push_back(0);
      if (!flat) displacement.push_back(0);
      x[0] += time * x[1];
    }
    const mesh::Geometry moved = mesh::compute_geometry(mesh, points);
    for (const Vec3& x : moved.cell_centre) {
      pressure.push_back(x[0] + time);
      for (int d = 0; d < mesh.dim; ++d) velocity.push_back(x[d]);
    }
    writer.write(time, points,
                 {{"displacement", "m", io::OutputField::Place::points, mesh.dim, displacement},
                  {"pressure", "Pa", io::OutputField::Place::cells, 1, pressure},
                  {"velocity", "m/s", io::OutputField::Place::cells, mesh.dim, velocity}});
  }
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    const linalg::PetscEnvironment petsc(MPI_COMM_WORLD);
    const std::string folder = argc > 1 ? argv[1] : ".";
    write_series(folder, "quadrilaterals", mesh::BoxCells::quadrilaterals);
    write_series(folder, "triangles", mesh::BoxCells::triangles);
    write_series(folder, "hexahedra", mesh::BoxCells::hexahedra);
    write_series(folder, "tetrahedra", mesh::BoxCells::tetrahedra);
    write_series(folder, "prisms", mesh::BoxCells::prisms);
    write_series(folder, "mixed", mesh::BoxCells::mixed);
  }
  MPI_Finalize();
  return 0;
}
