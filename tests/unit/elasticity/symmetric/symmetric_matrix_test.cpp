// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_matrix.hpp"

#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::symmetric_diagonal_test {
using namespace elastic;
using namespace mesh;

constexpr LameConstants lame{1.1, 1.7};

/// Largest part by which the diagonal passes that of the assembled matrix, and by which it stays below.
std::pair<double, double> beside_the_matrix(BoxCells cells, const BoundaryRow& second) {
  RawMesh raw = make_box(cells, {5, 4, 4}, Vec3(0.1, 0.2, 0.3), Vec3(1.1, 1.0, 1.4));
  perturb_interior(raw, 0.2, 7);
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
  std::vector<BoundaryRow> conditions(mesh.patches.size(), free_row());
  conditions[0] = fixed_row();
  conditions[1] = second;
  const ElasticOperator rows(mesh, geometry, conditions, lame);
  const SymmetricDiagonal diagonal = symmetric_diagonal(mesh, rows, VolumeStrain::faces);
  const linalg::SparseMatrix matrix = symmetric_matrix(mesh, rows, {});

  const std::size_t dim = mesh.dim, n_cells = std::size_t(mesh.cells.n_owned());
  EXPECT_EQ(diagonal.cells.size(), n_cells * dim);
  EXPECT_EQ(diagonal.faces.size(), rows.unknown_faces().size());
  ::PetscInt first = 0, end = 0;
  MatGetOwnershipRange(matrix.petsc(), &first, &end);
  double above = 0, below = 0;
  const auto compare = [&](std::size_t i, std::size_t j, double got) {
    const ::PetscInt row = first + ::PetscInt(i), column = first + ::PetscInt(j);
    double wanted = 0, size = 0;
    MatGetValues(matrix.petsc(), 1, &row, 1, &column, &wanted);
    MatGetValues(matrix.petsc(), 1, &row, 1, &row, &size);
    above = std::max(above, (got - wanted) / size);
    below = std::max(below, (wanted - got) / size);
  };
  for (std::size_t i = 0; i < n_cells * dim; ++i) compare(i, i, diagonal.cells[i]);
  for (std::size_t i = 0; i < diagonal.faces.size(); ++i)
    for (std::size_t a = 0; a < dim; ++a)
      for (std::size_t b = 0; b < (second.mirrored ? 0 : dim); ++b)
        compare((n_cells + i) * dim + a, (n_cells + i) * dim + b, diagonal.faces[i](Index(a), Index(b)));
  return {above, below};
}

class Diagonal : public ::testing::TestWithParam<BoxCells> {};

TEST_P(Diagonal, is_that_of_the_assembled_faces) {
  const auto [above, below] = beside_the_matrix(GetParam(), free_row());
  EXPECT_LT(above, 1e-12);
  EXPECT_LT(below, 1e-12);
}

// The image of the cells counts, what the vertices on the plane are not free to do is left out.
TEST_P(Diagonal, of_cells_is_near_it_beside_a_plane_of_symmetry) {
  const auto [above, below] = beside_the_matrix(GetParam(), mirror_row());
  EXPECT_LT(above, 0.1);
  EXPECT_LT(below, 0.1);
}

INSTANTIATE_TEST_SUITE_P(All, Diagonal,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

}  // namespace couplet::symmetric_diagonal_test
