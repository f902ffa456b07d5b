// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/io/series.hpp"
#include "coupler/acceleration/accelerator.hpp"
#include "coupler/exchange/partners.hpp"
#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/parameters.hpp"
#include "coupler/parameters/schedule.hpp"
#include "coupler/pass.hpp"

namespace couplet::coupler {

/// Integrals of transferred data over interfaces (`coupling.watch`):
///   amounts (N, W)            sum of each component
///   one value q per place     int q dA and its mean
///   a vector q of dim values  int q . n dA, flux out of the participant; for a velocity the swept volume [m^3/s]
/// Vertex data are averaged over the corners of faces. Areas are those of the moved surface if the
/// participant has a displacement and lists its corners, otherwise of the reference configuration. 2-D: per
/// meter of depth.
class InterfaceIntegrals {
 public:
  /// Throws Error for a missing participant or datum, or data without an integral. Collective.
  InterfaceIntegrals(MPI_Comm comm, const std::vector<Side>& sides,
                     const std::map<std::string, IntegralParameters>& watched);

  /// For example "tip force x [N]".
  const std::vector<std::string>& columns() const { return columns_; }
  /// One value per column, equal on all ranks; NaN for a datum not yet transferred. Collective.
  std::vector<double> row(const std::vector<coupling::Exchange>& given,
                          const std::vector<coupling::Exchange>& taken) const;

 private:
  enum class Kind { amount, scalar, flux };
  struct IntegratedSurface {
    std::size_t side;
    int dim;
    FaceCorners corners;
    bool moves;  // areas follow the displacement
  };
  struct Integral {
    std::size_t surface;
    Kind kind;
    coupling::Interface::Datum datum;
    std::size_t places;  // faces (vertices for amounts there) of this rank
    std::size_t columns;
  };
  Integral integral_of(const std::string& name, const IntegralParameters& p, const Side& side,
                       const IntegratedSurface& surface) const;
  std::vector<Vec3> areas(const IntegratedSurface& s, const coupling::Exchange& given,
                          const coupling::Exchange& taken) const;
  void add_up(const Integral& i, const std::vector<double>& values, const std::vector<Vec3>& areas,
              double* sums) const;

  MPI_Comm comm_;
  std::vector<IntegratedSurface> surfaces_;
  std::vector<Integral> integrals_;
  std::vector<std::string> columns_;
};

/// Output of the coupler by rank 0: residuals.csv (per pass), participants.csv (per step: working and waiting
/// times, reports, the coupler's own time), balance.csv (forces, moments, work), amounts.csv (transferred
/// sums), volume.csv (levels of closed fluids), watch.csv (requested integrals), the console line of each
/// step and the closing summary.
class Monitor {
 public:
  /// `names`: names of all participants. `restart_time`: NaN for a fresh start.
  Monitor(MPI_Comm comm, std::filesystem::path folder, std::vector<std::string> names, double end_time,
          double restart_time);
  /// Starts the clock of the first step; earlier work is not counted.
  void start(const std::vector<Partner>& partners);
  void iteration(const coupling::Step& step, int number, const Residual& residual, double omega);
  /// Adds a row to a table, which is opened with its first row; nothing without columns.
  void row(const char* file, double time, const std::vector<std::string>& columns,
           const std::vector<double>& values);
  void step(const coupling::Step& step, double time, const FixedPointResult& result,
            const std::vector<Partner>& partners);
  /// Mean and largest number of iterations, and time per participant.
  std::string summary(int halvings) const;
  /// Mean and largest number.
  std::vector<double> iterations_per_step() const {
    return {double(iterations_) / double(std::max(1L, steps_)), double(most_iterations_)};
  }
  /// See waiting_sentence().
  std::string waiting(const std::vector<Partner>& partners, const Schedule& schedule) const;

 private:
  using Clock = std::chrono::steady_clock;
  std::filesystem::path folder_;
  bool writes_;
  std::vector<std::string> names_;
  std::optional<io::Series> residuals_, participants_;
  std::map<std::string, io::Series> tables_;  // opened so far
  double end_time_, restart_time_, start_time_;
  Clock::time_point start_ = Clock::now(), step_start_ = Clock::now(), last_line_{};
  long steps_ = 0, iterations_ = 0, most_iterations_ = 0;
  std::vector<double> worked_;  // seconds per participant over the run
  double wall_ = 0;
  double own_ = 0, own_before_ = 0;  // CPU seconds of the coupler: total, and up to this step
};

/// Names the participant for which the others wait, from their times at work [s]. Empty for one participant or
/// a short run. `couplet run -n TOTAL` divides the ranks by the work of the last run.
std::string waiting_sentence(const std::vector<std::string>& names, const std::vector<double>& seconds,
                             bool side_by_side);

/// Resultants of the loads on one side of the interface.
struct Balance {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 moment = Vec3::Zero();  ///< about the origin, on the reference configuration [N m]
  double work = 0;             ///< over the step [J]
};

/// Sums the forces (data in N at faces or vertices) of one side and their work along the displacement of
/// vertices, or of faces, which move by the mean of their vertices.
class Balancing {
 public:
  /// Throws Error if a face refers to a missing vertex. Collective.
  Balancing(MPI_Comm comm, const Side& side);
  /// False if the side does not list the vertices of faces, so that forces at faces have no known work.
  bool knows_work() const { return knows_work_; }
  /// `data`: this rank's values of `of`. `increment`: displacement of the step [m], dim values per vertex.
  /// Equal on all ranks. Collective.
  Balance operator()(const coupling::Exchange& data, const std::vector<coupling::Interface::Datum>& of,
                     const std::vector<double>& increment) const;

 private:
  MPI_Comm comm_;
  int dim_;
  std::vector<Vec3> centres_, vertices_;
  bool knows_work_ = false;
  Transfer to_faces_;  // means over the faces
};

/// Forces and work of one participant over a step.
struct SideBalance {
  std::string label;   ///< role or name
  bool gives = false;  ///< it gives the load (a fluid), otherwise it takes it
  Balance balance;
};

/// Participants with forces at moving walls. The work of a fluid's walls and that taken by structures must
/// agree. Each side uses its load and its own wall motion. The fluid's wall is that of its last pass, in the
/// explicit scheme the guess.
class Mechanics {
 public:
  /// `labels`: one per side, for columns.
  Mechanics(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
            std::vector<std::string> labels);

  bool empty() const { return members_.empty(); }
  /// True if all sides list the vertices of their faces, so that work can be compared.
  bool knows_work() const { return knows_work_; }
  int dim() const { return dim_; }
  /// Returns balances of the accepted step from given and taken data, and moves the walls. Collective.
  std::vector<SideBalance> accepted(const std::vector<coupling::Exchange>& given,
                                    const std::vector<coupling::Exchange>& taken);

  /// Displacement of each member's wall at t^n, for checkpoints.
  std::vector<std::vector<double>>& walls() { return walls_; }
  const std::vector<std::vector<double>>& walls() const { return walls_; }
  std::size_t side_of_wall(std::size_t i) const { return members_[i].side; }

 private:
  struct Member {
    std::size_t side;
    bool gives;  // it gives the load
    Balancing balancing;
    std::vector<coupling::Interface::Datum> loads;
  };
  std::vector<Member> members_;
  std::vector<std::string> labels_;
  std::vector<std::vector<double>> walls_;
  bool knows_work_ = true;
  int dim_ = 3;
};

/// Output files of the coupler: tables, balances of forces and work, integrals over interfaces.
class Record {
 public:
  Record(MPI_Comm comm, const CouplingParameters& parameters, const Pass& pass);
  /// Opens the files. `restart_time`: NaN for a fresh start.
  void open(const std::filesystem::path& folder, double end_time, double restart_time);
  /// Forces and work of the accepted step on both sides. Moves the walls. Collective.
  const std::vector<SideBalance>& balance();
  /// Records an accepted step.
  void accepted(double time, VolumeLevel* level);

  Monitor& monitor() { return *monitor_; }
  const Mechanics& mechanics() const { return mechanics_; }
  const std::vector<SideBalance>& balances() const { return balances_; }
  void visit(io::Archive& archive);

 private:
  parallel::GlobalOrder order_of_wall(std::size_t i) const;
  void write_balance(double time);

  MPI_Comm comm_;
  const CouplingParameters& parameters_;
  const Pass& pass_;
  Mechanics mechanics_;
  std::vector<SideBalance> balances_;  // of the last accepted step
  std::optional<Monitor> monitor_;
  std::optional<InterfaceIntegrals> watched_;
};

}  // namespace couplet::coupler
