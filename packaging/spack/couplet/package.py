# SPDX-License-Identifier: Apache-2.0
"""Recipe of Spack, for a repository of your own: docs/how-to/build-elsewhere.md. Its package names and variants are those of
Spack's own repository; it has not been concretized or built with Spack."""
from spack.package import *


class Couplet(CMakePackage):
    """Couples solvers of fluids, solids, plates and heat storage into one MPI job, described by one YAML file."""

    git = "file:///home/me/couplet"  # your clone

    license("Apache-2.0")

    version("main", branch="main")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("pkgconfig", type="build")

    depends_on("mpi")
    depends_on("petsc~complex+mpi+double")
    depends_on("slepc")
    depends_on("hdf5+mpi+hl")
    depends_on("scotch+mpi")
    depends_on("lapack")
    depends_on("zlib-api")
    for library in ("eigen@3.4:", "yaml-cpp", "cli11", "spdlog", "fmt", "pugixml", "muparser", "nanoflann"):
        depends_on(library)
    for package in ("python@3.11:", "py-numpy", "py-pyyaml", "py-h5py", "py-matplotlib"):
        depends_on(package, type=("build", "run"))
    depends_on("gmsh", type="run")

    def cmake_args(self):
        return [self.define("COUPLET_TESTS", False)]
