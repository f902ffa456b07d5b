// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/linalg/petsc_cycle.hpp"

#include <petscksp.h>

#include <memory>

#include "common/linalg/petsc.hpp"

namespace couplet::benchmark {

using namespace linalg;
namespace {

struct Component {
  Mat a = nullptr;
  PC pc = nullptr;
  ::Vec b = nullptr, x = nullptr;
};

Component component_of(const ComponentMultigrid::Rows& rows,
                       const ComponentMultigrid::MultigridOptions& options, int c) {
  Component made;
  const PetscInt n = rows.size();
  const auto number = [&](Index i) { return static_cast<PetscInt>(options.map->global(i)); };
  petsc_check(MatCreate(options.comm, &made.a));
  petsc_check(MatSetSizes(made.a, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  petsc_check(MatSetType(made.a, MATAIJ));
  std::vector<PetscInt> own(std::size_t(n), 1), other(std::size_t(n), 0);
  for (Index i = 0; i < n; ++i)
    for (Index e = rows.offset[i]; e < rows.offset[i + 1]; ++e) ++(rows.index[e] < n ? own : other)[i];
  petsc_check(MatXAIJSetPreallocation(made.a, 1, own.data(), other.data(), nullptr, nullptr));
  for (Index i = 0; i < n; ++i) {
    const PetscInt row = number(i);
    petsc_check(MatSetValue(made.a, row, row, rows.diagonal[i][c], ADD_VALUES));
    for (Index e = rows.offset[i]; e < rows.offset[i + 1]; ++e)
      petsc_check(MatSetValue(made.a, row, number(rows.index[e]), rows.value[e][c], ADD_VALUES));
  }
  petsc_check(MatAssemblyBegin(made.a, MAT_FINAL_ASSEMBLY));
  petsc_check(MatAssemblyEnd(made.a, MAT_FINAL_ASSEMBLY));
  petsc_check(MatSetOption(made.a, MAT_SYMMETRIC, PETSC_TRUE));
  petsc_check(MatSetOption(made.a, MAT_SPD, PETSC_TRUE));
  petsc_check(MatCreateVecs(made.a, &made.x, &made.b));
  petsc_check(PCCreate(options.comm, &made.pc));
  petsc_check(PCSetOperators(made.pc, made.a, made.a));
  petsc_check(PCSetFromOptions(made.pc));
  petsc_check(PCSetUp(made.pc));
  petsc_check(PCSetUpOnBlocks(made.pc));
  return made;
}

}  // namespace

elastic::ComponentCycle petsc_cycle(ComponentMultigrid::Rows rows,
                                    const ComponentMultigrid::MultigridOptions& options) {
  auto components = std::make_shared<std::vector<Component>>();
  for (int c = 0; c < ComponentMultigrid::lanes; ++c) {
    float off = 0;  // unused lanes are empty
    for (const auto& value : rows.value) off += value[c];
    if (off != 0) components->push_back(component_of(rows, options, c));
  }
  return [components, n = std::size_t(rows.size())](std::span<const double> b, std::span<double> x, int dim) {
    for (int c = 0; c < dim; ++c) {
      Component& one = (*components)[std::size_t(c)];
      PetscScalar* to = nullptr;
      const PetscScalar* from = nullptr;
      petsc_check(VecGetArrayWrite(one.b, &to));
      for (std::size_t i = 0; i < n; ++i) to[i] = b[i * std::size_t(dim) + std::size_t(c)];
      petsc_check(VecRestoreArrayWrite(one.b, &to));
      petsc_check(PCApply(one.pc, one.b, one.x));
      petsc_check(VecGetArrayRead(one.x, &from));
      for (std::size_t i = 0; i < n; ++i) x[i * std::size_t(dim) + std::size_t(c)] = from[i];
      petsc_check(VecRestoreArrayRead(one.x, &from));
    }
  };
}

}  // namespace couplet::benchmark
