// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/output/interface_output.hpp"
#include "coupler/output/monitor.hpp"
#include "coupler/output/watch_integrals.hpp"
#include "coupler/pass.hpp"

namespace couplet::coupler {

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

/// Output files of the coupler: tables, balances of forces and work, interface data.
class Record {
 public:
  Record(MPI_Comm comm, const CouplingParameters& parameters, const Pass& pass);
  /// Opens the files. `restart_time`: NaN for a fresh start.
  void open(const std::filesystem::path& folder, double end_time, double restart_time);
  /// Forces and work of the accepted step on both sides. Moves the walls. Collective.
  const std::vector<SideBalance>& balance();
  /// Records an accepted step. `output`: number of the output that is due, or -1.
  void accepted(double time, int output, VolumeLevel* level);

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
  std::optional<InterfaceOutput> interface_output_;
  std::optional<WatchIntegrals> watched_;
};

}  // namespace couplet::coupler
