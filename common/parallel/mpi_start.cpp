// SPDX-License-Identifier: Apache-2.0
#include "common/parallel/mpi_start.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

// client/transports.cpp reads the user's files and variables in the same way. Change both.
namespace couplet::parallel {
namespace {

bool has_variable_like(std::string_view prefix) {
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (std::string_view(*entry).starts_with(prefix)) return true;
  return false;
}

/// Returns true if a line of the file sets one of the parameters that are set here.
bool speaks_of_transports(const std::filesystem::path& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::string name = line.substr(first, line.find_first_of(" \t=", first) - first);
    if (name != "pml" && name != "btl" && name != "mtl" && name != "ess") continue;
    // "btl = ^openib" only excludes transports, as distributions do, none of which is set here.
    const std::size_t value = line.find_first_not_of(" \t=", first + name.size());
    if (value != std::string::npos && line[value] != '^') return true;
  }
  return false;
}

bool user_has_chosen() {
  for (const char* name : {"OMPI_MCA_pml", "OMPI_MCA_btl", "OMPI_MCA_mtl", "OMPI_MCA_mca_param_files"})
    if (std::getenv(name) != nullptr) return true;
  const char* home = std::getenv("HOME");
  return speaks_of_transports("/etc/openmpi/openmpi-mca-params.conf") ||
         (home != nullptr && speaks_of_transports(std::filesystem::path(home) / ".openmpi/mca-params.conf"));
}

}  // namespace

bool has_open_mpi_launcher() { return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr; }

void prepare_mpi_start() {
  const char* all = std::getenv("OMPI_COMM_WORLD_SIZE");
  const char* here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  const bool on_one_machine = all != nullptr && here != nullptr && std::string_view(all) == here;
  const bool alone = all == nullptr && !has_variable_like("PMIX_") && !has_variable_like("PMI_") &&
                     std::getenv("SLURM_PROCID") == nullptr;
  if ((!alone && !on_one_machine) || user_has_chosen()) return;
  if (alone) {
    ::setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    // All isolated programs of a user are job 0 and share a session folder, which the first to end removes
    // while the next one starts. A program alone needs neither that folder nor shared memory.
    ::setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  }
  // Shared file pointers are not used. By default one is in the launcher's session folder, which vanishes
  // when a process of the job dies. The others would then fail to open files before the cause is reported.
  ::setenv("OMPI_MCA_sharedfp", "individual", 0);
  ::setenv("OMPI_MCA_pml", "ob1", 0);
  ::setenv("OMPI_MCA_btl", alone ? "self" : "self,vader", 0);
}

}  // namespace couplet::parallel
