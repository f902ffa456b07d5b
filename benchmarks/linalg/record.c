// SPDX-License-Identifier: Apache-2.0
// Replaces KSPSolve if loaded before PETSc (LD_PRELOAD). The COUPLET_RECORD_SOLVE-th solve of a program
// writes its matrix, right-hand side, guess and final residual norm to COUPLET_RECORD_FOLDER (PETSc binary
// files). The last solve before it that built a preconditioner writes its matrix. At the end it writes the
// solves per preconditioner and their iterations. The program is not affected.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <petscksp.h>
#include <stdio.h>
#include <stdlib.h>

static long solves = 0, built = 0, iterations = 0;

static const char* path(const char* name, int ranks) {
  static char text[4096];
  snprintf(text, sizeof text, "%s/%s-%d", getenv("COUPLET_RECORD_FOLDER"), name, ranks);
  return text;
}

static PetscErrorCode write_vector(MPI_Comm comm, const char* name, int ranks, Vec v) {
  PetscViewer file;
  PetscCall(PetscViewerBinaryOpen(comm, path(name, ranks), FILE_MODE_WRITE, &file));
  PetscCall(VecView(v, file));
  return PetscViewerDestroy(&file);
}

static PetscErrorCode write_matrix(KSP ksp, const char* name) {
  MPI_Comm comm = PetscObjectComm((PetscObject)ksp);
  Mat a;
  int ranks;
  PetscViewer file;
  MPI_Comm_size(comm, &ranks);
  PetscCall(KSPGetOperators(ksp, &a, NULL));
  PetscCall(PetscViewerBinaryOpen(comm, path(name, ranks), FILE_MODE_WRITE, &file));
  PetscCall(MatView(a, file));
  return PetscViewerDestroy(&file);
}

static PetscErrorCode write_system(KSP ksp, Vec b, Vec x) {
  MPI_Comm comm = PetscObjectComm((PetscObject)ksp);
  int rank, ranks;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  Mat a;
  PetscReal relative, absolute, size;
  PetscInt rows;
  PetscCall(KSPGetOperators(ksp, &a, NULL));
  PetscCall(write_matrix(ksp, "A"));
  PetscCall(write_vector(comm, "b", ranks, b));
  PetscCall(write_vector(comm, "x", ranks, x));
  PetscCall(KSPGetTolerances(ksp, &relative, &absolute, NULL, NULL));
  PetscCall(VecNorm(b, NORM_2, &size));
  PetscCall(MatGetLocalSize(a, &rows, NULL));
  int mine = (int)rows, all[64];
  MPI_Gather(&mine, 1, MPI_INT, all, 1, MPI_INT, 0, comm);
  if (rank != 0) return 0;
  FILE* text = fopen(path("about", ranks), "w");
  if (!text) return PETSC_ERR_FILE_OPEN;
  fprintf(text, "%.17g\n", relative * size > absolute ? relative * size : absolute);
  for (int r = 0; r < ranks; ++r) fprintf(text, "%d\n", all[r]);
  return fclose(text) ? PETSC_ERR_FILE_WRITE : 0;
}

PetscErrorCode KSPSolve(KSP ksp, Vec b, Vec x) {
  static PetscErrorCode (*real)(KSP, Vec, Vec) = NULL;
  if (!real) real = (PetscErrorCode(*)(KSP, Vec, Vec))dlsym(RTLD_NEXT, "KSPSolve");
  const char *folder = getenv("COUPLET_RECORD_FOLDER"), *number = getenv("COUPLET_RECORD_SOLVE");
  const char* prefix = NULL;
  PetscCall(KSPGetOptionsPrefix(ksp, &prefix));
  if (!folder || !number || prefix) return real(ksp, b, x);  // those within preconditioners have a prefix
  PC pc;
  PetscBool kept;
  PetscInt n;
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCGetReusePreconditioner(pc, &kept));
  ++solves;
  if (!kept) ++built;
  if (!kept && solves <= atol(number)) PetscCall(write_matrix(ksp, "P"));
  if (solves == atol(number)) PetscCall(write_system(ksp, b, x));
  PetscCall(real(ksp, b, x));
  PetscCall(KSPGetIterationNumber(ksp, &n));
  iterations += n;
  int ranks;
  MPI_Comm_size(PetscObjectComm((PetscObject)ksp), &ranks);
  FILE* text = fopen(path("counts", ranks), "w");
  if (!text) return PETSC_ERR_FILE_OPEN;
  fprintf(text, "%ld %ld %ld\n", solves, built, iterations);
  return fclose(text) ? PETSC_ERR_FILE_WRITE : 0;
}
