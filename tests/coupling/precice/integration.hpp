// SPDX-License-Identifier: Apache-2.0
// Stands for preCICE's testing headers while its integration tests run, unchanged, on this project's library. integration.py makes
// headers of their names that include this one.
#pragma once

#include <mpi.h>

#include <Eigen/Core>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "precice/precice.hpp"

#define PRECICE_ASSERT(...) static_cast<void>(0)
#define PRECICE_UNREACHABLE(...) std::abort()
#define PRECICE_INFO(...) static_cast<void>(_log)
#define PRECICE_DEBUG(...) static_cast<void>(_log)
#define PRECICE_WARN(...) static_cast<void>(_log)

namespace precice {

using Rank = int;
using DataID = int;
using MeshID = int;

namespace logging {
struct Logger {
  template <class Name>
  explicit Logger(Name&&) {}
};
}  // namespace logging

namespace utils {
struct Parallel {
  struct State {
    MPI_Comm comm;
  };
  static std::shared_ptr<State> current();
};
}  // namespace utils

namespace testing {

struct Ranks {
  int value;
};
struct ParticipantState {
  std::string name;
  int size = 1;
  explicit ParticipantState(std::string of) : name(std::move(of)) {}
  ParticipantState& operator()(Ranks ranks) {
    size = ranks.value;
    return *this;
  }
  ParticipantState& setupIntraComm() { return *this; }
};
enum class Require { PETSc, Events, Ginkgo };

inline namespace inject {
constexpr Ranks operator""_ranks(unsigned long long n) { return {int(n)}; }
constexpr Ranks operator""_rank(unsigned long long n) { return {int(n)}; }
inline ParticipantState operator""_on(const char* name, std::size_t) { return ParticipantState(name); }
}  // namespace inject

struct TestSetup {
  template <class... Parts>
  explicit TestSetup(Parts... parts) {
    (add(parts), ...);
  }
  void add(const ParticipantState& p) { participants.push_back(p); }
  void add(Ranks ranks) { participants.push_back(ParticipantState("Unnamed")(ranks)); }
  void add(Require) {}
  std::vector<ParticipantState> participants;
};

/// Decorator of a test with its participants.
class SetUp : public boost::unit_test::decorator::base {
 public:
  explicit SetUp(TestSetup of) : setup(std::move(of)) {}
  TestSetup setup;

 private:
  void apply(boost::unit_test::test_unit&) override {}
  boost::unit_test::decorator::base_ptr clone() const override {
    return boost::unit_test::decorator::base_ptr(new SetUp(*this));
  }
};
template <class... Parts>
SetUp testSetup(Parts... parts) {
  return SetUp(TestSetup(parts...));
}

/// Place of this process in the test that runs: after the coupler, or alone as the participant TEST_ALONE.
class TestContext {
 public:
  TestContext();
  std::string config() const;
  std::string prefix(const std::string& file) const;
  bool hasSize(int n) const { return size == n; }
  bool isNamed(const std::string& of) const;
  bool isRank(Rank r) const { return r == rank; }
  bool isPrimary() const { return rank == 0; }
  MPI_Comm* comm() { return &comm_; }
  std::string describe() const { return name; }

  std::string name;
  Rank rank = 0;
  int size = 1;
  bool invalid = false;

 private:
  std::set<std::string> names_;
  MPI_Comm comm_ = MPI_COMM_SELF;
};

template <class A, class B>
bool equals(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b, double within = 1e-9) {
  return a
      .binaryExpr(b,
                  [within](double x, double y) {
                    const double most = std::max(std::abs(x), std::abs(y));
                    return most < within || std::abs(x - y) <= within * most;
                  })
      .all();
}
inline bool equals(const std::vector<double>& a, const std::vector<double>& b, double within = 1e-9) {
  using Values = Eigen::Map<const Eigen::VectorXd>;
  return a.size() == b.size() &&
         equals(Values(a.data(), Eigen::Index(a.size())), Values(b.data(), Eigen::Index(b.size())), within);
}
inline bool equals(double a, double b, double within = 1e-9) { return std::abs(a - b) <= within; }

std::string getPathToSources();
std::string getTestName();
void expectFile(const std::string& name);
template <class... Names>
void expectFiles(Names... names) {
  (expectFile(names), ...);
}
std::function<bool(const ::precice::Error&)> errorContains(std::string text);

}  // namespace testing
}  // namespace precice

#define PRECICE_TEST_SETUP(...) BOOST_TEST_DECORATOR(*precice::testing::testSetup(__VA_ARGS__))
#define PRECICE_TEST()                   \
  precice::testing::TestContext context; \
  if (context.invalid) return

using namespace precice::testing::inject;
