// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/diagnostics/results.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/quadratic_fit.hpp"
#include "solid_solver/body/recovered_strain.hpp"
#include "solid_solver/body/stress.hpp"
#include "solid_solver/output/probes.hpp"

namespace couplet::solid {

Vec3 quadratic_displacement(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index cell,
                            const Vec3& place, std::span<const double> cell_u,
                            std::span<const double> face_u) {
  const mesh::Geometry& g = rows.geometry();
  const int dim = mesh.dim;
  const Vec3 centre = g.cell_centre[cell];
  const mesh::Csr faces_of_cell = boundary_faces_of_cells(mesh);
  std::vector<Index> cells, mark(std::size_t(mesh.cells.n_local()), -1);
  gather_cells(mesh, mesh::transpose(mesh.cell_points, 0, mesh.points.n_local()), cell, mark, cells);
  std::ranges::sort(cells);
  std::vector<MirrorPlane> mirrors;
  double reach = 0;
  for (const Index c : cells) {
    reach = std::max(reach, (g.cell_centre[c] - centre).norm());
    for (const Index f : faces_of_cell[c])
      if (rows.mirrored(f)) add_mirror(g, f, mirrors);
  }
  QuadraticFit fit;
  fit.start(dim, 3, centre, reach > 0 ? reach : std::pow(g.volume[cell], 1. / dim));
  const auto add = [&](const Vec3& x, const Vec3& value) {
    fit.add_near(x, {value.data(), 3});
    for (const MirrorPlane& m : mirrors) {
      const Vec3 image = m.reflect(value);
      fit.add_near(m.image(x), {image.data(), 3});
    }
  };
  for (const Index c : cells) {
    add(g.cell_centre[c], elastic::vector_at(cell_u, c, dim));
    for (const Index f : faces_of_cell[c])
      if (!rows.mirrored(f)) add(g.face_centre[f], elastic::vector_at(face_u, f - mesh.n_interior, dim));
  }
  fit.solve_near();
  return fit.coefficients().transpose() * fit.terms(place);
}

namespace {

using Values = std::vector<double>;

Values rows_of_points(const SolidBody& body, std::span<const double> weights) {
  elastic::SymmetricSpace space(body.mesh(), body.elastic());
  space.clear_forces();
  const int dim = body.mesh().dim;
  for (Index v = 0; v * dim < Index(weights.size()); ++v)
    space.force(space.place_of_point(v)) = elastic::vector_at(weights, v, dim);
  Values rows(body.elastic().n_unknowns(), 0);
  space.add_collected(rows);
  return rows;
}

/// Transpose of the gradient of FaceRows: forces of sum_f stress_f : G_f.
Values rows_of_stress(const SolidBody& body, const std::vector<Tensor3>& stress) {
  elastic::SymmetricSpace space(body.mesh(), body.elastic());
  space.clear_forces();
  for (Index f = 0; f < body.mesh().n_flux_faces(); ++f) {
    if (stress[std::size_t(f)].isZero(0)) continue;
    const elastic::FaceRows face = elastic::symmetric_rows(body.mesh(), body.elastic(), f);
    for (const auto& [place, b] : face.all()) space.force(place) += stress[std::size_t(f)] * b;
  }
  Values rows(body.elastic().n_unknowns(), 0);
  space.add_collected(rows);
  return rows;
}

}  // namespace

DualProblem::DualProblem(const SolidBody& body, std::span<const double> unknowns,
                         std::span<const double> known)
    : body_(body), strain_(strains_of(unknowns, known)) {}

std::vector<Tensor3> DualProblem::strains_of(std::span<const double> unknowns,
                                             std::span<const double> known) const {
  const Index n = body_.mesh().n_flux_faces();
  std::vector<Tensor3> strain(static_cast<std::size_t>(n));
  body_.kernel().face_gradients(
      unknowns, known, [&](Index f, const Tensor3& g) { strain[std::size_t(f)] = 0.5 * (g + g.transpose()); },
      0, n);
  return strain;
}

std::vector<double> DualProblem::of_points(std::span<const double> weights) const {
  return rows_of_points(body_, weights);
}

std::vector<double> DualProblem::of_stress(std::span<const Index> cells, const Tensor3& weights) const {
  const mesh::Mesh& mesh = body_.mesh();
  double volume = 0;
  std::vector<Tensor3> stress(std::size_t(mesh.n_flux_faces()), Tensor3::Zero());
  elastic::visit_pyramids(body_.mesh(), body_.geometry(), [&](Index c, Index f, double v) {
    if (std::ranges::find(cells, c) == cells.end()) return;
    volume += v;
    stress[std::size_t(f)] += v * body_.elastic().stress(c, weights);  // C is symmetric
  });
  volume = parallel::sum(mesh.comm, volume);
  for (Tensor3& s : stress) s /= volume;
  return rows_of_stress(body_, stress);
}

double DualProblem::missed(std::span<const double> j, SolutionMethod& method) const {
  Values z(j.size(), 0);
  method.solve(j, z);
  return missed_product(body_.mesh(), body_.elastic(), strain_, strains_of(z, {}));
}

namespace {

std::string method_of(const QuantityEstimate& q) {
  return q.body > 0 && q.error() == q.body ? "as the whole body" : "dual-weighted";
}

/// Distributes a probe value from rank 0 to all ranks.
double shared(MPI_Comm comm, const std::vector<double>& sampled, std::size_t i) {
  return parallel::sum(comm, sampled.empty() ? 0 : sampled[i]);
}

class Estimates {
 public:
  Estimates(const SolidBody& body, const SolidFields& fields, const SolidState& state, SolutionMethod& method)
      : body_(body),
        mesh_(body.mesh()),
        fields_(fields),
        state_(state),
        method_(method),
        points_(fields.point_displacement()),
        dual_(body, body.unknowns_of(state.cell_u, state.face_u), state.known) {}

  QuantityEstimate of(const std::string& name, const SolidQuantity& quantity) const {
    QuantityEstimate e{
        .name = name, .what = quantity.field, .unit = quantity.field == "displacement" ? "m" : "Pa"};
    if (!quantity.component.empty()) e.what += " " + quantity.component;
    e.place = quantity.point.empty() ? place_of_largest_stress(body_, fields_, points_) : place_of(quantity);
    const io::Probe probe(mesh_, body_.geometry().points, name, e.place);
    e.place = probe.place();
    if (quantity.field == "displacement")
      take_displacement(probe, quantity.component[0] - 'x', e);
    else
      take_stress(probe, quantity.component, e);
    return e;
  }

 private:
  void take_displacement(const io::Probe& probe, int a, QuantityEstimate& e) const {
    const std::size_t dim = std::size_t(mesh_.dim);
    e.value = shared(mesh_.comm, probe.sample(points_, mesh_.dim), std::size_t(a));
    std::vector<double> weights(points_.size(), 0);
    for (std::size_t i = 0; i < probe.points().size(); ++i)
      weights[std::size_t(probe.points()[i]) * dim + std::size_t(a)] = probe.weights()[i];
    e.dual = dual_.missed(dual_.of_points(weights), method_);
    double sum = 0, n = 0;
    for (const Index c : cells_at(mesh_, probe)) {
      sum += quadratic_displacement(mesh_, body_.elastic(), c, e.place, state_.cell_u, state_.face_u)[a];
      n += 1;
    }
    e.local = parallel::sum(mesh_.comm, sum) / parallel::sum(mesh_.comm, n) - e.value;
  }

  void take_stress(const io::Probe& probe, const std::string& component, QuantityEstimate& e) const {
    const StressRecovery& recovery = fields_.recovery();
    const DiscreteStress found = fields_.discrete_stress(points_);
    const std::vector<std::uint8_t> wanted = flags_of(mesh_, probe.points());
    const SidedTensors stress = recovery.at_points(found, wanted);
    const auto left = recovery.left_at_points(found, wanted, stress);
    const Side side = worst_side_at(probe, materials_at(mesh_, probe), stress, mesh_.comm);
    const Tensor3 tensor = unpack(side.tensor), weights = weights_of(component, tensor);
    e.value = component.empty() ? equivalent_stress(tensor) : contraction(weights, tensor);
    e.local = shared(mesh_.comm, probe.sample(left[std::size_t(side.material)], 1), 0) * tensor.norm();
    std::vector<Index> cells = cells_at(mesh_, probe);
    std::erase_if(cells, [&](Index c) { return mesh_.material_of(c) != side.material; });
    e.dual = dual_.missed(dual_.of_stress(cells, weights), method_);
  }

  /// d value / d stress: of an equivalent stress 3/2 s / |value|, s the deviator.
  static Tensor3 weights_of(const std::string& component, const Tensor3& stress) {
    if (component.empty()) {
      const double size = equivalent_stress(stress);
      return size > 0 ? Tensor3(1.5 / size * (stress - stress.trace() / 3 * Tensor3::Identity()))
                      : Tensor3(Tensor3::Zero());
    }
    Tensor3 weights = Tensor3::Zero();
    const int i = component[0] - 'x', j = component[1] - 'x';
    weights(i, j) += 0.5, weights(j, i) += 0.5;
    return weights;
  }

  const SolidBody& body_;
  const mesh::Mesh& mesh_;
  const SolidFields& fields_;
  const SolidState& state_;
  SolutionMethod& method_;
  const std::vector<double> points_;
  const DualProblem dual_;
};

}  // namespace

Vec3 place_of(const SolidQuantity& quantity) {
  Vec3 place = Vec3::Zero();
  for (std::size_t a = 0; a < quantity.point.size(); ++a) place[Eigen::Index(a)] = quantity.point[a];
  return place;
}

// NaN is treated as largest.
double QuantityEstimate::error() const {
  if (std::isnan(local) || std::isnan(dual)) return std::nan("");
  const double larger = std::max(std::abs(local), std::abs(dual));
  return std::max(body, is_signed ? std::max(std::abs(local + dual), larger / 2) : larger);
}

std::vector<QuantityEstimate> estimate_quantities(const SolidBody& body, const SolidFields& fields,
                                                  const SolidState& state, SolutionMethod& method) {
  if (!body.kernel().is_symmetric())
    throw Error(
        "quantities: their errors are estimated with 'solution-method: {face-gradient: symmetric}', the default; the matrix of "
        "the other gradients is not symmetric. couplet study --quantities estimates them from differences between runs.");
  const Estimates estimates(body, fields, state, method);
  std::vector<QuantityEstimate> found;
  for (const auto& [name, quantity] : body.parameters().quantities)
    found.push_back(estimates.of(name, quantity));
  return found;
}

void tell_quantities(MPI_Comm comm, const SolidContext& context, const std::vector<QuantityEstimate>& found) {
  const int rank = parallel::comm_rank(comm);
  for (const QuantityEstimate& q : found) {
    const double share = q.value != 0 ? q.error() / std::abs(q.value) : std::nan("");
    const std::string relative = std::isnan(share) ? "" : fmt::format(" ({:.2g} %)", 100 * share);
    const std::string error =
        std::isnan(q.error()) ? "unknown" : fmt::format("{:.2g} {}{}", q.error(), q.unit, relative);
    const std::string where = q.patch.empty()
                                  ? fmt::format("at ({:g}, {:g}, {:g}) m", q.place[0], q.place[1], q.place[2])
                                  : q.patch;
    diagnostics::finding(
        rank, {.id = "quantity-error",
               .severity = base::Severity::note,
               .number = share,
               .sentence = fmt::format("{}: {} {}: {:.6g} {}, estimated error {}, {}", q.name, q.what, where,
                                       q.value, q.unit, error, method_of(q))});
  }
  if (rank != 0) return;
  for (const QuantityEstimate& q : found)
    diagnostics::set_result({q.name + ": " + q.what,
                             q.unit,
                             {q.value},
                             q.value != 0 ? q.error() / std::abs(q.value) : std::nan(""),
                             q.patch.empty() ? diagnostics::place_text(q.place) : q.patch});
  if (context.output_folder.empty()) return;
  std::string text =
      "quantity,unit,value,estimated error,at the place,by the dual problem,of the whole body,method\n";
  for (const QuantityEstimate& q : found)
    text += fmt::format("\"{}\",{},{:.12g},{:.6g},{:.6g},{:.6g},{:.6g},{}\n", q.name, q.unit, q.value,
                        q.error(), q.local, q.dual, q.body, method_of(q));
  base::write_file(context.output_folder / "quantities.csv", text);
}

}  // namespace couplet::solid
