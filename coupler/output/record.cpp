// SPDX-License-Identifier: Apache-2.0
#include "coupler/output/record.hpp"

#include <fmt/format.h>

namespace couplet::coupler {
namespace {

/// Columns of balance.csv are named after roles, if there are any.
std::vector<std::string> labels_of(const CouplingParameters& p, const std::vector<Partner>& partners) {
  std::vector<std::string> labels;
  for (const Partner& partner : partners) {
    const std::string& name = partner.name();
    labels.push_back(!p.exchange && p.fluid && name == p.fluid->participant           ? "fluid"
                     : !p.exchange && p.structure && name == p.structure->participant ? "structure"
                                                                                      : name);
  }
  return labels;
}

}  // namespace

Record::Record(MPI_Comm comm, const CouplingParameters& parameters, const Pass& pass)
    : comm_(comm),
      parameters_(parameters),
      pass_(pass),
      mechanics_(comm, pass.sides(), pass.links(), labels_of(parameters, pass.partners())) {
  if (!parameters.watch.empty()) watched_.emplace(comm, pass.sides(), parameters.watch);
}

void Record::open(const std::filesystem::path& folder, double end_time, double restart_time) {
  std::vector<std::string> names;
  for (const Partner& p : pass_.partners()) names.push_back(p.name());
  monitor_.emplace(comm_, folder, names, end_time, restart_time);
  if (parameters_.interface_output)
    interface_output_.emplace(comm_, folder / "interface", pass_.sides(), restart_time);
  monitor_->start(pass_.partners());
}

const std::vector<SideBalance>& Record::balance() {
  balances_ = mechanics_.accepted(pass_.given(), pass_.taken());
  return balances_;
}

void Record::accepted(double time, int output, VolumeLevel* level) {
  if (level) monitor_->row("volume.csv", time, level->columns(), level->row());
  write_balance(time);
  if (parameters_.exchange) {
    std::vector<std::string> columns;
    std::vector<double> sums;
    for (const Links::Amount& amount : pass_.links().amounts(pass_.given()))
      columns.push_back(amount.column), sums.push_back(amount.value);
    monitor_->row("amounts.csv", time, columns, sums);
  }
  if (watched_)
    monitor_->row("watch.csv", time, watched_->columns(), watched_->row(pass_.given(), pass_.taken()));
  if (output >= 0 && interface_output_) interface_output_->write(time, output, pass_.given(), pass_.taken());
}

/// Forces and work of each side, then all moments.
void Record::write_balance(double time) {
  std::vector<std::string> columns;
  std::vector<double> values;
  const int dim = mechanics_.dim();
  const auto add = [&](std::string column, double value) {
    columns.push_back(std::move(column)), values.push_back(value);
  };
  for (const SideBalance& side : balances_) {
    for (int c = 0; c < dim; ++c)
      add(fmt::format("{} force {} [N]", side.label, "xyz"[c]), side.balance.force[c]);
    add(side.label + " work of the step [J]", side.balance.work);
  }
  for (const SideBalance& side : balances_)
    for (int c = dim == 2 ? 2 : 0; c < 3; ++c)
      add(fmt::format("{} moment {} [N m]", side.label, "xyz"[c]), side.balance.moment[c]);
  monitor_->row("balance.csv", time, columns, values);
}

/// Displacements of the wall of a participant that Mechanics watches.
parallel::GlobalOrder Record::order_of_wall(std::size_t i) const {
  return pass_.sides()[mechanics_.side_of_wall(i)].order(comm_, coupling::Interface::Place::vertices);
}

void Record::save(io::CheckpointWriter& file) const {
  for (std::size_t i = 0; i < mechanics_.walls().size(); ++i)
    file.write(order_of_wall(i), "wall-" + std::to_string(i), mechanics_.walls()[i]);
}

void Record::load(io::CheckpointReader& file) {
  for (std::size_t i = 0; i < mechanics_.walls().size(); ++i)
    file.read(order_of_wall(i), "wall-" + std::to_string(i), mechanics_.walls()[i]);
}

}  // namespace couplet::coupler
