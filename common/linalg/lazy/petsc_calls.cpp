// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/lazy/petsc_calls.hpp"

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "common/base/error.hpp"

// Of the module (petsc_module.c).
extern "C" {
int couplet_petsc_start(MPI_Comm program);
void couplet_petsc_stop(void);
const char* const* couplet_petsc_reasons(void);
// PETSc's own, which petsc_calls.S has in its place: names of what ended an iteration.
extern const char* const* KSPConvergedReasons;
}

namespace couplet::linalg {
namespace {

constexpr const char* module_name = "libcouplet_petsc.so";

/// PETSc is global: of one process there is one.
struct Petsc {
  MPI_Comm program = MPI_COMM_NULL;
  bool is_up = false;
};

Petsc& petsc() {
  static Petsc now;
  return now;
}

/// Found by the program's own search path: beside it where it was built or installed. Null: it cannot be opened.
void* opened_module() {
  static void* const handle = dlopen(module_name, RTLD_LAZY | RTLD_GLOBAL);
  return handle;
}

}  // namespace

void start_petsc_when_called(MPI_Comm program) { petsc() = {program, false}; }

void start_petsc() {
  Petsc& now = petsc();
  if (now.is_up || now.program == MPI_COMM_NULL) return;
  now.is_up = true;
  if (couplet_petsc_start(now.program) != 0) throw Error("PETSc could not be initialised.");
  KSPConvergedReasons = couplet_petsc_reasons();
}

void stop_petsc() {
  if (petsc().is_up) couplet_petsc_stop();
  petsc() = {};
}

}  // namespace couplet::linalg

/// For petsc_calls.S: the address of a function, when it is called for the first time. Nothing can be thrown through the
/// caller's frame: what cannot be found ends the program.
extern "C" void* couplet_petsc_call(const char* name) {
  using namespace couplet::linalg;
  void* const module = opened_module();
  if (module && !std::string_view(name).starts_with("couplet_")) start_petsc();
  // What was loaded before may stand in for a function (benchmarks/linalg/record.c).
  if (void* const address = module ? dlsym(RTLD_DEFAULT, name) : nullptr) return address;
  const char* why = dlerror();
  std::fprintf(
      stderr,
      "error: %s, which brings PETSc, is needed and cannot be used (%s): %s. Install Couplet whole, with its "
      "lib/couplet beside its bin, and PETSc.\n",
      module_name, name, why ? why : "no reason is known");
  std::exit(1);
}
