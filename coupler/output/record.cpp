// SPDX-License-Identifier: Apache-2.0
#include "coupler/output/record.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/mapping/face_weights.hpp"

namespace couplet::coupler {

Balancing::Balancing(MPI_Comm comm, const Side& side)
    : comm_(comm),
      dim_(side.interface.dim),
      centres_(side.interface.face_centres),
      vertices_(side.interface.vertices) {
  const coupling::Interface& i = side.interface;
  knows_work_ = parallel::sum(comm, GlobalIndex(i.face_vertices.size())) > 0;
  if (!knows_work_) return;
  for (const GlobalIndex vertex : i.face_vertices)
    if (vertex < 0 || vertex >= side.vertices.back())
      throw Error("'{}' has a face with vertex {}, but only {} vertices.", side.name, vertex,
                  side.vertices.back());
  to_faces_ = Transfer(comm, side.faces, side.vertices, vertices_to_faces(comm, i));
}

Balance Balancing::operator()(const coupling::Exchange& data,
                              const std::vector<coupling::Interface::Datum>& of,
                              const std::vector<double>& increment) const {
  Balance b;
  std::vector<double> moved;
  if (knows_work_) moved = to_faces_.apply(increment, dim_);
  for (const auto& datum : of) {
    const auto found = data.find(datum.name);
    if (found == data.end() || datum.unit != "N" || datum.size(dim_) != dim_) continue;
    const bool at_faces = datum.place == coupling::Interface::Place::faces;
    const std::vector<Vec3>& places = at_faces ? centres_ : vertices_;
    const std::vector<double>& way = at_faces ? moved : increment;
    for (std::size_t f = 0; f < places.size(); ++f) {
      Vec3 force = Vec3::Zero();
      for (int c = 0; c < dim_; ++c) {
        force[c] = found->second[f * std::size_t(dim_) + std::size_t(c)];
        if (!way.empty()) b.work += force[c] * way[f * std::size_t(dim_) + std::size_t(c)];
      }
      b.force += force;
      b.moment += places[f].cross(force);
    }
  }
  double sums[7] = {b.force.x(), b.force.y(), b.force.z(), b.moment.x(), b.moment.y(), b.moment.z(), b.work};
  MPI_Allreduce(MPI_IN_PLACE, sums, 7, MPI_DOUBLE, MPI_SUM, comm_);
  b.force = {sums[0], sums[1], sums[2]};
  b.moment = {sums[3], sums[4], sums[5]};
  b.work = sums[6];
  return b;
}

Mechanics::Mechanics(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                     std::vector<std::string> labels)
    : labels_(std::move(labels)) {
  for (std::size_t s = 0; s < sides.size(); ++s) {
    std::vector<coupling::Interface::Datum> loads;
    bool gives = false;
    for (const auto& link : links.all()) {
      coupling::Interface::Datum d = link.datum;
      if (d.unit != "N" || d.place != coupling::Interface::Place::faces ||
          (link.giver != s && link.taker != s))
        continue;
      gives = link.giver == s;
      if (!gives) d.place = link.to;
      if (!find_datum(loads, d.name)) loads.push_back(d);
    }
    const coupling::Interface& interface = sides[s].interface;
    if (loads.empty() ||
        !(find_datum(interface.takes, "displacement") || find_datum(interface.gives, "displacement")))
      continue;
    members_.push_back({s, gives, Balancing(comm, sides[s]), loads});
    walls_.emplace_back(interface.vertices.size() * std::size_t(interface.dim), 0.);
    dim_ = interface.dim;
    const bool by_vertex = std::ranges::all_of(
        loads, [](const auto& d) { return d.place == coupling::Interface::Place::vertices; });
    knows_work_ = knows_work_ && (by_vertex || members_.back().balancing.knows_work());
  }
}

std::vector<SideBalance> Mechanics::accepted(const std::vector<coupling::Exchange>& given,
                                             const std::vector<coupling::Exchange>& taken) {
  std::vector<SideBalance> list;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const Member& m = members_[i];
    const coupling::Exchange& motion = given[m.side].contains("displacement") ? given[m.side] : taken[m.side];
    const auto found = motion.find("displacement");
    const std::vector<double>& now = found == motion.end() ? walls_[i] : found->second;
    std::vector<double> increment(now.size());
    for (std::size_t k = 0; k < now.size(); ++k) increment[k] = now[k] - walls_[i][k];
    list.push_back(
        {labels_[m.side], m.gives, m.balancing(m.gives ? given[m.side] : taken[m.side], m.loads, increment)});
    if (found != motion.end()) walls_[i] = found->second;
  }
  return list;
}

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
  monitor_->start(pass_.partners());
}

const std::vector<SideBalance>& Record::balance() {
  balances_ = mechanics_.accepted(pass_.given(), pass_.taken());
  return balances_;
}

void Record::accepted(double time, VolumeLevel* level) {
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

void Record::visit(io::Archive& archive) {
  for (std::size_t i = 0; i < mechanics_.walls().size(); ++i)
    archive.field(order_of_wall(i), "wall-" + std::to_string(i), mechanics_.walls()[i]);
}

}  // namespace couplet::coupler
