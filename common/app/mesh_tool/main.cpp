// SPDX-License-Identifier: Apache-2.0
#include <mpi.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <optional>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/io/cut_mesh.hpp"
#include "common/mesh/distributed/mesh_block.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/parallel/collective.hpp"
#include "common/parallel/mpi_start.hpp"

namespace {

using namespace couplet;
namespace fs = std::filesystem;

struct Words {
  fs::path file, output;
  std::array<GlobalIndex, 3> cells{1, 1, 1};
  std::array<double, 3> length{1, 1, 1};
  bool tetrahedra = false, solid = false;
  int dimension = 3;
  mesh::MeshParameters parameters;
};

/// Peak memory of this process [MB].
double peak_memory() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  return double(used.ru_maxrss) / 1024;
}

void cut(MPI_Comm comm, const Words& words) {
  if (parallel::comm_size(comm) > 1)
    throw Error("A mesh is cut by one process, which reads it as a whole. Start mesh_tool without mpirun.");
  mesh::MeshBlock block = mesh::read_mesh(comm, words.file, words.dimension, words.parameters);
  mesh::drop_unused_points(comm, block);
  io::write_cut_mesh(comm, block, words.output);
  std::printf("%s: %lld cells, patches %s\n", words.output.c_str(),
              static_cast<long long>(block.cells.size()), base::join(block.patches).c_str());
}

void box(MPI_Comm comm, const Words& words) {
  mesh::BlockedBox box;
  box.tetrahedra = words.tetrahedra;
  box.n = words.cells;
  box.upper = Vec3(words.length[0], words.length[1], words.length[2]);
  io::write_cut_mesh(comm, mesh::box_block(comm, box), words.output);
}

/// Opens a mesh as the programs do and prints the cost.
void open(MPI_Comm comm, const Words& words) {
  const double start = MPI_Wtime(), before = peak_memory();
  const mesh::LoadedMesh loaded = io::load_mesh(comm, words.file, words.dimension, {}, {}, {}, words.solid);
  const double seconds = parallel::max(comm, MPI_Wtime() - start), after = peak_memory();
  const double cells = loaded.mesh.cells.n_owned(), local = loaded.mesh.cells.n_local();
  const double most = parallel::max(comm, cells), sum = parallel::sum(comm, cells);
  const double copies = parallel::sum(comm, local) / sum - 1;
  const double peaks = parallel::sum(comm, after), peak = parallel::max(comm, after),
               base = parallel::sum(comm, before);
  if (parallel::comm_rank(comm) == 0)
    std::printf(
        "%d ranks, %.0f cells, at most %.0f per rank, ghost cells per cell %.3f; %.2f s; peak of memory %.1f MB over all "
        "ranks, %.1f MB on one, of which %.1f MB were in use before\n",
        parallel::comm_size(comm), sum, most, copies, seconds, peaks, peak, base);
}

/// Parses assignments NAME=VALUE.
mesh::MeshParameters parameters_of(const std::vector<std::string>& assignments) {
  mesh::MeshParameters parameters;
  for (const std::string& text : assignments) {
    const auto sign = text.find('=');
    const auto value =
        sign == std::string::npos ? std::nullopt : csv::number_of(std::string_view(text).substr(sign + 1));
    if (!value) throw Error("--parameter {}: expected NAME=NUMBER.", text);
    parameters[text.substr(0, sign)] = *value;
  }
  return parameters;
}

int run(int argc, char** argv) {
  Words words;
  std::vector<std::string> assignments;
  CLI::App app("writes and checks meshes that any number of ranks can open together");
  app.require_subcommand(1);
  CLI::App* of_file = app.add_subcommand("cut", "writes a mesh (.msh, .geo, .inp, ...) as a cut mesh");
  of_file->add_option("file", words.file)->required();
  of_file->add_option("--parameter", assignments, "NAME=VALUE of the .geo; repeatable");
  CLI::App* of_box =
      app.add_subcommand("box", "writes a mesh of a box, of which each rank generates one block");
  of_box->add_option("--cells", words.cells, "hexahedra along x, y, z")->required();
  of_box->add_option("--length", words.length, "[m]");
  of_box->add_flag("--tetrahedra", words.tetrahedra, "cuts each hexahedron into six");
  for (CLI::App* writer : {of_file, of_box})
    writer->add_option("-o,--output", words.output, "the cut mesh, .h5")->required();
  CLI::App* opening =
      app.add_subcommand("open", "opens a mesh as the programs do and prints the time and memory required");
  opening->add_option("file", words.file)->required();
  opening->add_flag("--solid", words.solid,
                    "opens it as solid_solver does, with the data for surface stresses");
  for (CLI::App* reader : {of_file, opening})
    reader->add_option("--dimension", words.dimension, "dimension of the mesh")->check(CLI::Range(2, 3));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!*opening && words.output.extension() != ".h5")
    throw Error("The name of a cut mesh must end in .h5; found '{}'.", words.output.string());
  words.parameters = parameters_of(assignments);
  (*of_file ? cut : *of_box ? box : open)(MPI_COMM_WORLD, words);
  return 0;
}

/// Returns the exit code. Rank 0 prints exceptions.
int run_or_report(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::fprintf(stderr, "mesh_tool: %s\n", error.what());
    return dynamic_cast<const Error*>(&error) != nullptr ? 2 : 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  parallel::prepare_mpi_start();
  MPI_Init(&argc, &argv);
  const int code = run_or_report(argc, argv);
  MPI_Finalize();
  return code;
}
