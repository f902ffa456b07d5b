// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/io/probes/place_search.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {

namespace {

bool is_stress(std::string_view field) {
  return field == "stress" || field == "equivalent-stress" || field == "principal-stress";
}

constexpr double least_weight =
    1e-9;  // of a point in the value at a place; below, the place lies on a side without it

}  // namespace

std::vector<Index> cells_at(const mesh::Mesh& mesh, const io::Probe& probe) {
  std::vector<GlobalIndex> corners;
  for (std::size_t i = 0; i < probe.points().size(); ++i)
    if (probe.weights()[i] > least_weight) corners.push_back(mesh.point_id[probe.points()[i]]);
  corners = parallel::all_gather(mesh.comm, corners);
  std::vector<Index> cells;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const auto has = [&](GlobalIndex id) {
      return std::ranges::any_of(mesh.cell_points[c], [&](Index v) { return mesh.point_id[v] == id; });
    };
    if (std::ranges::all_of(corners, has)) cells.push_back(c);
  }
  return cells;
}

std::vector<int> materials_at(const mesh::Mesh& mesh, const io::Probe& probe) {
  if (number_of_materials(mesh) == 1) return {0};
  std::vector<int> materials;
  for (const Index c : cells_at(mesh, probe)) materials.push_back(mesh.material_of(c));
  materials = parallel::all_gather(mesh.comm, materials);
  std::ranges::sort(materials);
  materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
  return materials;
}

Side worst_side_at(const io::Probe& probe, const std::vector<int>& materials, const SidedTensors& sides,
                   MPI_Comm comm) {
  SidedTensors here;
  for (const int m : materials) here.push_back(probe.sample(sides[std::size_t(m)], tensor_size));
  Side worst{materials.front()};
  if (parallel::comm_rank(comm) == 0) {
    std::ranges::copy(worst_side(here), worst.tensor.begin());
    const auto is_worst = [&](const auto& side) { return std::ranges::equal(side, worst.tensor); };
    worst.material = materials.at(std::size_t(std::ranges::find_if(here, is_worst) - here.begin()));
  }
  MPI_Bcast(&worst.material, 1, MPI_INT, 0, comm);
  MPI_Bcast(worst.tensor.data(), tensor_size, MPI_DOUBLE, 0, comm);
  return worst;
}

std::vector<std::uint8_t> flags_of(const mesh::Mesh& mesh, std::span<const Index> points) {
  std::vector<double> flags(std::size_t(mesh.points.n_local()), 0);
  for (const Index v : points) flags[std::size_t(v)] = 1;
  mesh.points.add_to_owners(flags);
  mesh.points.update_ghosts(flags);
  return {flags.begin(), flags.end()};
}

SolidProbes::SolidProbes(const SolidBody& body, const SolidFields& derived) : body_(body), derived_(derived) {
  std::vector<Vec3> places;
  for (const auto& [name, chosen] : body.parameters().probes) {
    places.push_back(chosen.point);
    io::Probe probe(body.mesh(), body.geometry().points, name, chosen.point);
    std::vector<int> materials = materials_at(body.mesh(), probe);
    probes_.push_back({name, std::move(probe), chosen.fields, std::move(materials)});
    for (const std::string& field : chosen.fields) add_columns(name, field);
  }
  io::check_mesh_scale(body.mesh(), body.geometry().points, places, body.parameters().mesh_scale);
  std::vector<Index> stressed;
  for (const Watched& watched : probes_)
    if (std::ranges::any_of(watched.fields, is_stress))
      stressed.insert(stressed.end(), watched.probe.points().begin(), watched.probe.points().end());
  if (watches_stress()) stressed_ = flags_of(body.mesh(), stressed);
}

void SolidProbes::add_columns(const std::string& probe, const std::string& field) {
  const auto vector = [&](const std::string& what, const char* unit) {
    for (int a = 0; a < body_.mesh().dim; ++a)
      columns_.push_back(probe + " " + what + base::axis_letters[a] + " [" + unit + "]");
  };
  const auto tensor = [&](const char* unit) {
    for (const char* component : tensor_component)
      columns_.push_back(probe + " " + field + "-" + component + " [" + unit + "]");
  };
  if (field == "acceleration" && body_.parameters().analysis == SolidParameters::Analysis::static_)
    throw Error("probes.{}: a static analysis has no acceleration.", probe);
  if (field == "displacement") return vector("", "m");
  if (field == "velocity") return vector("velocity ", "m/s");
  if (field == "acceleration") return vector("acceleration ", "m/s^2");
  if (field == "stress") return tensor("Pa");
  if (field == "strain") return tensor("-");
  if (field == "equivalent-stress") return columns_.push_back(probe + " equivalent-stress [Pa]");
  if (field == "principal-stress") {
    for (const char* i : {"1", "2", "3"}) columns_.push_back(probe + " principal-stress-" + i + " [Pa]");
    return;
  }
  if (!body_.temperature())
    throw Error("probes: the field '{}' is requested, but nothing in this case computes it.", field);
  columns_.push_back(probe + " temperature [K]");
}

bool SolidProbes::watches_stress() const {
  return std::ranges::any_of(probes_,
                             [](const Watched& w) { return std::ranges::any_of(w.fields, is_stress); });
}

bool SolidProbes::any_watches(const char* field) const {
  return std::ranges::any_of(probes_, [&](const Watched& w) { return std::ranges::count(w.fields, field); });
}

std::vector<double> SolidProbes::sample(std::span<const double> points) const {
  const int dim = body_.mesh().dim;
  std::vector<double> velocity, acceleration, row;
  SidedTensors stress, strain;
  if (any_watches("velocity")) velocity = derived_.point_velocity();
  if (any_watches("acceleration")) acceleration = derived_.point_acceleration();
  if (watches_stress()) stress = derived_.stress_sides(points, stressed_);
  if (any_watches("strain")) strain = derived_.strain_sides(points);
  for (const Watched& watched : probes_) {
    for (const std::string& field : watched.fields) {
      std::vector<double> values;
      if (field == "displacement") {
        values = watched.probe.sample(points, dim);
      } else if (field == "velocity") {
        values = watched.probe.sample(velocity, dim);
      } else if (field == "acceleration") {
        values = watched.probe.sample(acceleration, dim);
      } else if (field == "strain" || is_stress(field)) {
        const PackedTensor tensor = worst_side_at(watched.probe, watched.materials,
                                                  field == "strain" ? strain : stress, body_.mesh().comm)
                                        .tensor;
        if (parallel::comm_rank(body_.mesh().comm) != 0) continue;
        values.assign(tensor.begin(), tensor.end());
        if (field == "equivalent-stress") values = {equivalent_stress(unpack(tensor))};
        if (field == "principal-stress") {
          const auto principal = principal_stresses(unpack(tensor));
          values.assign(principal.begin(), principal.end());
        }
      } else {
        values = watched.probe.sample(body_.temperature()->of_points(), 1);
      }
      row.insert(row.end(), values.begin(), values.end());
    }
  }
  return row;
}

std::vector<SolidProbes::Stress> SolidProbes::stresses(const DiscreteStress& of) const {
  if (!watches_stress()) return {};
  const SidedTensors stress = derived_.recovery().at_points(of, stressed_);
  const auto left = derived_.recovery().left_at_points(of, stressed_, stress);
  std::vector<Stress> found;
  for (const Watched& watched : probes_) {
    if (std::ranges::none_of(watched.fields, is_stress)) continue;
    const Side side = worst_side_at(watched.probe, watched.materials, stress, body_.mesh().comm);
    const std::vector<double> share = watched.probe.sample(left[std::size_t(side.material)], 1);
    if (!share.empty())
      found.push_back(
          {watched.name, watched.probe.place(), equivalent_stress(unpack(side.tensor)), share[0]});
  }
  return found;
}

namespace {

/// Points of the cells and boundary faces with at least three quarters of the largest equivalent stress before recovery, because recovery
/// of the whole field takes longer than the solve. Collective.
std::vector<std::uint8_t> points_of_large_stress(const mesh::Mesh& mesh, const DiscreteStress& found) {
  std::vector<double> stress(std::size_t(mesh.cells.n_owned()));
  for (std::size_t c = 0; c < stress.size(); ++c) stress[c] = equivalent_stress(found.cells[c]);
  for (std::size_t b = 0; b < found.faces.size(); ++b) {
    double& there = stress[std::size_t(mesh.owner[mesh.n_interior + Index(b)])];
    there = std::max(there, equivalent_stress(found.faces[b]));
  }
  const double most = parallel::max(mesh.comm, stress.empty() ? 0 : std::ranges::max(stress));
  std::vector<Index> wanted;
  for (std::size_t c = 0; c < stress.size(); ++c)
    if (stress[c] >= 0.75 * most)
      for (const Index v : mesh.cell_points[Index(c)]) wanted.push_back(v);
  return flags_of(mesh, wanted);
}

/// Largest equivalent stress of the recovered field. Probes interpolate between points and the equivalent stress is convex, so
/// none sees more than the points.
ReportedStress largest(const SolidBody& body, const SolidFields& fields, const DiscreteStress& found) {
  const mesh::Mesh& mesh = body.mesh();
  std::vector<std::uint8_t> wanted = points_of_large_stress(mesh, found);
  const SidedTensors sides = fields.recovery().at_points(found, wanted);
  struct Seen {
    double value = -1;
    GlobalIndex point = -1;  // the same one on any number of ranks
    int material = 0;
    Vec3 place = Vec3::Zero();
    bool is_below(const Seen& other) const {
      constexpr double more = 1 + 1e-9;  // of values that round-off alone tells apart
      return other.value > more * value || (other.value * more >= value && other.point < point);
    }
  };
  Seen most;
  for (std::size_t m = 0; m < sides.size(); ++m)
    for (Index v = 0; v < mesh.points.n_owned(); ++v) {
      if (!wanted[std::size_t(v)]) continue;
      const double value =
          equivalent_stress(unpack(std::span(sides[m]).subspan(std::size_t(v) * tensor_size, tensor_size)));
      const Seen here{value, mesh.point_id[v], int(m), body.geometry().points[v]};
      if (most.is_below(here)) most = here;
    }
  for (const Seen& one : parallel::all_gather(mesh.comm, std::vector<Seen>{most}))
    if (most.is_below(one)) most = one;
  std::ranges::fill(wanted, 0);
  const auto at = std::ranges::find(mesh.point_id, most.point) - mesh.point_id.begin();
  if (at < mesh.points.n_local()) wanted[std::size_t(at)] = 1;
  const auto all_left = fields.recovery().left_at_points(found, wanted, sides);
  const double left = parallel::sum(
      mesh.comm, at < mesh.points.n_owned() ? all_left[std::size_t(most.material)][std::size_t(at)] : 0);
  return {"largest", most.place, most.value, left};
}

}  // namespace

Vec3 place_of_largest_stress(const SolidBody& body, const SolidFields& fields,
                             std::span<const double> points) {
  return largest(body, fields, fields.discrete_stress(points)).place;
}

std::vector<ReportedStress> reported_stresses(const SolidBody& body, const SolidFields& fields,
                                              const SolidProbes& probes) {
  if (!recovers_stress(body)) return {};
  const DiscreteStress stress = fields.discrete_stress(fields.point_displacement());
  std::vector<ReportedStress> found;
  for (const SolidProbes::Stress& one : probes.stresses(stress))
    found.push_back({fmt::format("at probe '{}'", one.probe), one.place, one.equivalent,
                     body.is_dynamic() ? std::nan("") : one.left});
  if (!body.is_dynamic()) {
    const ReportedStress most = largest(body, fields, stress);
    if (parallel::comm_rank(body.mesh().comm) == 0 && most.value > 0) found.push_back(most);
  }
  return found;
}

}  // namespace couplet::solid
