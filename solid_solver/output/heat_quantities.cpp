// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/heat_quantities.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/probes/probe.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/thermal/heat_defects.hpp"

namespace couplet::solid {
namespace {

class HeatEstimates {
 public:
  explicit HeatEstimates(const Heat& heat)
      : heat_(heat),
        conduction_(heat.conduction()),
        mesh_(conduction_.mesh()),
        points_(heat.point_temperature(heat.accepted())),
        fits_(local_heat(heat, heat.accepted())),
        source_missed_(HeatAnswer(heat).source_missed()),
        flux_missed_(conduction_.flux_faces().size()) {
    HeatAnswer(heat).boundaries().fluxes_missed(conduction_, heat.accepted().time, flux_missed_);
  }

  QuantityEstimate of(const std::string& name, const SolidQuantity& quantity) const {
    return quantity.field == "heat" ? through(name, quantity.patch) : at(name, place_of(quantity));
  }

 private:
  QuantityEstimate at(const std::string& name, const Vec3& place) const {
    const mesh::Geometry& g = conduction_.geometry();
    const io::Probe probe(mesh_, g.points, name, place);
    QuantityEstimate e{.name = name, .what = "temperature", .unit = "K", .place = probe.place()};
    const std::vector<double> sampled = probe.sample(points_, 1);
    e.value = parallel::sum(mesh_.comm, sampled.empty() ? 0 : sampled[0]);
    double sum = 0, n = 0;
    for (const Index c : cells_at(mesh_, probe))
      sum += fits_[std::size_t(c)].at(e.place - g.cell_centre[c]), n += 1;
    e.local = is_given(probe) ? 0 : parallel::sum(mesh_.comm, sum) / parallel::sum(mesh_.comm, n) - e.value;
    e.dual = -missed(rows_of(probe), std::vector<double>(conduction_.n_known(), 0));
    e.is_signed = true;
    return e;
  }

  /// All of its vertices have a prescribed temperature.
  bool is_given(const io::Probe& probe) const {
    double solved = 0;
    for (std::size_t i = 0; i < probe.points().size(); ++i)
      if (!std::ranges::count(conduction_.known_points(), probe.points()[i]))
        solved += std::abs(probe.weights()[i]);
    return parallel::sum(mesh_.comm, solved) < 1e-9;
  }

  /// A source of 1 W where the temperature is read, in the nodes that it is read from.
  std::vector<double> rows_of(const io::Probe& probe) const {
    std::vector<double> cells(std::size_t(mesh_.cells.n_local()), 0),
        faces(std::size_t(mesh_.boundary.n_local()), 0);
    std::vector<double> shares(std::size_t(mesh_.points.n_local()), 0);
    for (std::size_t i = 0; i < probe.points().size(); ++i)
      shares[std::size_t(probe.points()[i])] += probe.weights()[i];
    // Points have their nodes on their owner.
    mesh_.points.add_to_owners(shares);
    for (Index v = 0; v < mesh_.points.n_owned(); ++v) {
      if (shares[std::size_t(v)] == 0 || std::ranges::count(conduction_.known_points(), v)) continue;
      const auto nodes = conduction_.vertices().nodes(v);
      const auto weights = conduction_.vertices().weights(v);
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Index b = nodes[i] - mesh_.cells.n_local();
        (b < 0 ? cells[std::size_t(nodes[i])] : faces[std::size_t(b)]) += shares[std::size_t(v)] * weights[i];
      }
    }
    mesh_.cells.add_to_owners(cells);
    mesh_.boundary.add_to_owners(faces);
    return in_rows(cells, faces);
  }

  /// Heat that enters at a flux face stands in the face's row and in its cell's.
  std::vector<double> in_rows(std::span<const double> cells, std::span<const double> faces) const {
    std::vector<double> rows(conduction_.n_unknowns(), 0);
    const auto n_owned = std::size_t(mesh_.cells.n_owned());
    std::copy_n(cells.begin(), n_owned, rows.begin());
    const auto& flux = conduction_.flux_faces();
    for (std::size_t i = 0; i < flux.size(); ++i) {
      const double heat = faces[std::size_t(flux[i] - mesh_.n_interior)];
      rows[n_owned + i] = heat;
      if (conduction_.condition(flux[i]) == fv::HeatCondition::flux)
        rows[std::size_t(mesh_.owner[flux[i]])] += heat;
    }
    return rows;
  }

  /// w = 1 on the patch, 0 on the others that have a temperature; a film's ambient temperature likewise.
  QuantityEstimate through(const std::string& name, const std::string& patch) const {
    QuantityEstimate e{.name = name, .what = "heat into the solid through", .unit = "W", .patch = patch};
    for (const PatchHeat& h : heat_.patch_heat())
      if (h.patch == patch) e.value = h.heat;
    std::vector<double> known(conduction_.n_known(), 0), faces(std::size_t(mesh_.boundary.n_local()), 0);
    const mesh::Patch& here = *mesh_.find_patch(patch);
    const auto is_here = [&](Index f) { return f >= here.first && f < here.first + here.count; };
    HeatAnswer(heat_).boundaries().mark_known(conduction_, patch, known);
    const std::vector<double> transfer = HeatAnswer(heat_).transfer();
    const auto& flux = conduction_.flux_faces();
    for (std::size_t i = 0; i < transfer.size(); ++i)
      if (is_here(flux[i])) faces[std::size_t(flux[i] - mesh_.n_interior)] = transfer[i];
    for (std::size_t i = 0; i < flux.size(); ++i)
      if (is_here(flux[i])) e.local += flux_missed_[i];
    e.local = parallel::sum(mesh_.comm, e.local);
    e.is_signed = true;
    e.dual = missed(in_rows(std::vector<double>(std::size_t(mesh_.cells.n_owned()), 0), faces), known);
    return e;
  }

  double missed(std::vector<double> rows, std::vector<double> known) const {
    const HeatState z = HeatAnswer(heat_).field(std::move(rows), std::move(known));
    double source = 0;
    for (std::size_t c = 0; c < source_missed_.size(); ++c) source += z.cells[c] * source_missed_[c];
    for (std::size_t i = 0; i < flux_missed_.size(); ++i)
      source += z.boundary[std::size_t(conduction_.flux_faces()[i] - mesh_.n_interior)] * flux_missed_[i];
    return weighted_defect(heat_, fits_, z) - parallel::sum(mesh_.comm, source);
  }

  const Heat& heat_;
  const fv::ConductionOperator& conduction_;
  const mesh::Mesh& mesh_;
  const std::vector<double> points_;
  const std::vector<LocalHeat> fits_;
  const std::vector<double> source_missed_;
  std::vector<double> flux_missed_;
};

}  // namespace

void check_heat_quantities(const Heat& heat, const std::map<std::string, SolidQuantity>& quantities) {
  if (quantities.empty()) return;
  const mesh::Mesh& mesh = heat.conduction().mesh();
  if (HeatAnswer(heat).properties_vary())
    throw Error(
        "quantities: the conductivity varies with the temperature; their errors are estimated where it is constant. 'couplet study "
        "--quantities' estimates them by differences of coarser runs.");
  std::vector<std::string> patches;
  for (const mesh::Patch& patch : mesh.patches)
    if (!patch.bonded) patches.push_back(patch.name);
  for (const auto& [name, quantity] : quantities) {
    if (quantity.field == "heat" && !std::ranges::count(patches, quantity.patch))
      throw Error("quantities.{}: the mesh has no patch '{}'. {}", name, quantity.patch,
                  base::did_you_mean(quantity.patch, patches, "patches"));
    if (quantity.field != "heat")
      io::Probe(mesh, heat.conduction().geometry().points, name, place_of(quantity));
  }
}

std::vector<QuantityEstimate> estimate_heat_quantities(
    const Heat& heat, const std::map<std::string, SolidQuantity>& quantities) {
  std::vector<QuantityEstimate> found;
  if (quantities.empty()) return found;
  const HeatEstimates estimates(heat);
  for (const auto& [name, quantity] : quantities) found.push_back(estimates.of(name, quantity));
  return found;
}

}  // namespace couplet::solid
