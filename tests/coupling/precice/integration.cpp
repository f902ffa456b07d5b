// SPDX-License-Identifier: Apache-2.0
// Main program of preCICE's integration tests. LIST=1: prints file, full name, name and participants of each. Otherwise each process
// writes the result of the test given by --run_test to RESULTS/<rank>.
#include "integration.hpp"

#include <boost/test/tools/fpc_tolerance.hpp>
#include <boost/test/tree/traverse.hpp>
#include <boost/test/tree/visitor.hpp>
#include <cstdio>
#include <filesystem>

#include "couplet_precice.h"

namespace framework = boost::unit_test::framework;

namespace precice {
namespace {

MPI_Comm communicator = MPI_COMM_SELF;

const testing::SetUp& setup_of(const boost::unit_test::test_unit& test) {
  for (const auto& decorator : test.p_decorators.get())
    if (const auto* found = dynamic_cast<const testing::SetUp*>(decorator.get())) return *found;
  throw std::runtime_error("the test has no PRECICE_TEST_SETUP");
}

std::string file_of(const boost::unit_test::test_unit& test) {
  return {test.p_file_name.begin(), test.p_file_name.end()};
}

/// Name of a test; of the suite if its tests are those of data.
std::string name_of(const boost::unit_test::test_unit& test) {
  const std::string name = test.p_name;
  return name[0] == '_' ? framework::get<boost::unit_test::test_suite>(test.p_parent_id).p_name.get() : name;
}

struct Lister : boost::unit_test::test_tree_visitor {
  void visit(const boost::unit_test::test_case& test) override {
    std::printf("%s\t%s\t%s", file_of(test).c_str(), test.full_name().c_str(), name_of(test).c_str());
    for (const auto& p : setup_of(test).setup.participants) std::printf("\t%s:%d", p.name.c_str(), p.size);
    std::printf("\n");
  }
};

bool nothing() { return true; }

}  // namespace

std::shared_ptr<utils::Parallel::State> utils::Parallel::current() {
  return std::make_shared<State>(State{communicator});
}

namespace testing {

TestContext::TestContext() {
  int at = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &at);
  const char* alone = std::getenv("TEST_ALONE");
  if (!alone) --at;  // the coupler is the first
  invalid = true;
  for (const ParticipantState& p : setup_of(framework::current_test_case()).setup.participants) {
    names_.insert(p.name);
    if (invalid && (alone ? p.name == alone : at < p.size)) {
      name = p.name, size = p.size, rank = at, invalid = false;
      if (size > 1) comm_ = alone ? MPI_COMM_WORLD : couplet_precice_comm(name.c_str());
      if (size > 1) MPI_Comm_rank(comm_, &rank);
    }
    if (!alone) at -= p.size;
  }
  communicator = comm_;
}

std::string TestContext::config() const { return prefix(getTestName() + ".xml"); }

std::string TestContext::prefix(const std::string& file) const {
  return (std::filesystem::path(file_of(framework::current_test_case())).parent_path() / file).string();
}

bool TestContext::isNamed(const std::string& of) const {
  if (!names_.count(of)) throw std::runtime_error("the test has no participant " + of);
  return name == of;
}

std::string getPathToSources() { return std::string(std::getenv("PRECICE_SOURCES")) + "/src"; }
std::string getTestName() { return name_of(framework::current_test_case()); }
void expectFile(const std::string& name) { BOOST_TEST(std::filesystem::is_regular_file(name), name); }
std::function<bool(const ::precice::Error&)> errorContains(std::string text) {
  return [text](const ::precice::Error& error) {
    return std::string(error.what()).find(text) != std::string::npos;
  };
}

}  // namespace testing
}  // namespace precice

int main(int argc, char** argv) {
  if (std::getenv("LIST")) {
    framework::init(precice::nothing, argc, argv);
    framework::finalize_setup_phase();
    precice::Lister lister;
    boost::unit_test::traverse_test_tree(framework::master_test_suite(), lister, true);
    return 0;
  }
  int rank = 0, down = 0;
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  // The tolerance of preCICE's own main program for numbers without one.
  boost::test_tools::fpc_tolerance<double>() = boost::test_tools::fpc_tolerance<float>() = 1e-9;
  const int result = boost::unit_test::unit_test_main(precice::nothing, argc, argv);
  std::ofstream(std::string(std::getenv("RESULTS")) + "/" + std::to_string(rank)) << result;
  MPI_Finalized(&down);
  if (!down) MPI_Finalize();
  return 0;
}
