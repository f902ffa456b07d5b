// SPDX-License-Identifier: Apache-2.0
// Selects the same Open MPI transports on one machine as the programs of the job. Different choices are
// incompatible, and probing all networks is slow. common/parallel/mpi_start.cpp does the same; a client
// shares no code with the rest, so change both (tests/coupling/client starts them together).
#include "transports.hpp"

#include <cstdlib>
#include <fstream>
#include <string>

namespace couplet::wire {
namespace {

/// Returns true if a user parameter "pml = ...", "btl = ..." or "mtl = ..." selects transports ("^" only
/// excludes).
bool chooses(const std::string& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::size_t end = line.find_first_of(" \t=", first);
    const std::string name = line.substr(first, end - first);
    const std::size_t value = end == std::string::npos ? end : line.find_first_not_of(" \t=", end);
    if ((name == "pml" || name == "btl" || name == "mtl" || name == "ess") && value != std::string::npos &&
        line[value] != '^')
      return true;
  }
  return false;
}

}  // namespace

void choose_transports() {
  const char *all = std::getenv("OMPI_COMM_WORLD_SIZE"), *here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  if (all == nullptr || here == nullptr || std::string(all) != here) return;
  for (const char* name : {"OMPI_MCA_pml", "OMPI_MCA_btl", "OMPI_MCA_mtl", "OMPI_MCA_mca_param_files"})
    if (std::getenv(name) != nullptr) return;
  const char* home = std::getenv("HOME");
  if (chooses("/etc/openmpi/openmpi-mca-params.conf")) return;
  if (home != nullptr && chooses(std::string(home) + "/.openmpi/mca-params.conf")) return;
  ::setenv("OMPI_MCA_pml", "ob1", 0);
  ::setenv("OMPI_MCA_btl", "self,vader", 0);
}

}  // namespace couplet::wire
