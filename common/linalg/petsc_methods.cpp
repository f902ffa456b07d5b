// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/petsc_methods.hpp"

#include "common/linalg/petsc_check.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::linalg {
namespace {

// PETSc's own factorisation has no dense kernels: it wins on small matrices (low overhead), MUMPS on large
// ones.
constexpr GlobalIndex largest_for_petsc = 12000;

void choose_petsc_factors(PC pc, bool symmetric) {
  petsc_check(PCSetType(pc, symmetric ? PCCHOLESKY : PCLU));
  petsc_check(PCFactorSetMatSolverType(pc, MATSOLVERPETSC));
  petsc_check(PCFactorSetMatOrderingType(pc, MATORDERINGND));
}

// Small systems on several ranks are factorised whole on each: less latency than a distributed solve, and the
// same bits in every run, where MUMPS adds in the order in which messages happen to arrive.
void choose_factors(PC pc, const SparseMatrix& matrix, bool symmetric) {
  PetscInt rows = 0;
  petsc_check(MatGetSize(matrix.petsc(), &rows, nullptr));
  if (rows > largest_for_petsc) {
    petsc_check(PCSetType(pc, symmetric ? PCCHOLESKY : PCLU));
    petsc_check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
    return;
  }
  if (parallel::comm_size(matrix.comm()) == 1) return choose_petsc_factors(pc, symmetric);
  petsc_check(PCSetType(pc, PCREDUNDANT));
  KSP whole = nullptr;
  PC factors = nullptr;
  petsc_check(PCRedundantSetNumber(pc, parallel::comm_size(matrix.comm())));
  petsc_check(PCRedundantGetKSP(pc, &whole));
  petsc_check(KSPGetPC(whole, &factors));
  choose_petsc_factors(factors, symmetric);
}

// ML's smoothed aggregation with one symmetric SOR sweep: the best packaged preconditioner on FV Laplacians.
// The spectral radius in its prolongation smoother is bounded by the matrix norm: ML's other estimate starts from
// random vectors whose sequence goes on from set-up to set-up, so that a run that was stopped would not go on
// with the same bits (2 % more iterations on the thin plate's fluid).
void choose_ml(PC pc) {
  petsc_check(PCSetType(pc, PCML));
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_ml_mg_levels_ksp_type", "richardson"));
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_ml_mg_levels_ksp_max_it", "1"));
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_ml_mg_levels_pc_type", "sor"));
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_ml_pc_ml_SpectralNormScheme_Anorm", "true"));
  petsc_check(PCSetOptionsPrefix(pc, "couplet_ml_"));
  petsc_check(PCSetFromOptions(pc));
}

}  // namespace

void choose_cholmod(PC pc) {
  petsc_check(PetscOptionsSetValue(nullptr, "-mat_cholmod_supernodal_switch", "1e10"));
  petsc_check(PCSetType(pc, PCCHOLESKY));
  petsc_check(PCFactorSetMatSolverType(pc, MATSOLVERCHOLMOD));
}

void choose_method(KSP ksp, PC pc, const SparseMatrix& matrix, LinearMethod method) {
  switch (method) {
    case LinearMethod::direct:
    case LinearMethod::direct_symmetric:
      petsc_check(KSPSetType(ksp, KSPPREONLY));
      return choose_factors(pc, matrix, method == LinearMethod::direct_symmetric);
    case LinearMethod::direct_planar:
      petsc_check(KSPSetType(ksp, KSPPREONLY));
      return parallel::comm_size(matrix.comm()) == 1 ? choose_cholmod(pc) : choose_factors(pc, matrix, true);
    case LinearMethod::cg_direct:
    case LinearMethod::cg_single:
      petsc_check(KSPSetType(ksp, KSPCG));
      petsc_check(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
      return parallel::comm_size(matrix.comm()) == 1 ? choose_cholmod(pc) : choose_factors(pc, matrix, true);
    case LinearMethod::cg_multigrid:
      petsc_check(KSPSetType(ksp, KSPCG));
      petsc_check(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
      return choose_ml(pc);
    case LinearMethod::gmres_multigrid:
      petsc_check(KSPSetType(ksp, KSPGMRES));
      petsc_check(KSPSetPCSide(ksp, PC_RIGHT));
      petsc_check(PCSetType(pc, PCHYPRE));
      petsc_check(PCHYPRESetType(pc, "boomeramg"));
      return;
    case LinearMethod::bicgstab_ilu:
      petsc_check(KSPSetType(ksp, KSPBCGS));
      petsc_check(KSPSetPCSide(ksp, PC_RIGHT));
      petsc_check(PCSetType(pc, PCBJACOBI));
      return;
    case LinearMethod::cg_icc:
      petsc_check(KSPSetType(ksp, KSPCG));
      petsc_check(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
      petsc_check(PCSetType(pc, PCBJACOBI));
      petsc_check(PetscOptionsSetValue(nullptr, "-couplet_icc_sub_pc_type", "icc"));
      petsc_check(PCSetOptionsPrefix(pc, "couplet_icc_"));
      petsc_check(PCSetFromOptions(pc));
      return;
  }
}

}  // namespace couplet::linalg
