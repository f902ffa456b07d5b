// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/stress_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "common/diagnostics/finding.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/material/stress.hpp"

namespace couplet::solid {
namespace {

// From here on a stress at a probe is told as doubtful.
constexpr double doubtful = 0.3;

double larger_of(double left, double mesh) { return std::isnan(left) ? left : std::fmax(left, mesh); }

/// Flags of the points of the cell with the largest equivalent stress, its own or that of a boundary face. Collective.
std::vector<std::uint8_t> points_of_largest(const SolidBody& body, const SolidFields& fields,
                                            std::span<const double> points) {
  const mesh::Mesh& mesh = body.mesh();
  double most = -1;
  Index at = -1;
  const auto see = [&](Index cell, const Tensor3& stress) {
    if (const double value = equivalent_stress(stress); value > most) most = value, at = cell;
  };
  const std::vector<Tensor3> cells = fields.cell_stress(points);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) see(c, cells[std::size_t(c)]);
  const std::vector<Tensor3> faces = fields.face_stress(mesh.n_interior, mesh.boundary.n_owned(), points);
  for (Index b = 0; b < mesh.boundary.n_owned(); ++b)
    see(mesh.owner[mesh.n_interior + b], faces[std::size_t(b)]);
  // The same cell whatever the number of ranks.
  const double largest = parallel::max(mesh.comm, most);
  const double id = most == largest && at >= 0 ? double(mesh.cell_id[at]) : 1e300;
  std::vector<double> flags(std::size_t(mesh.points.n_local()), 0);
  if (parallel::min(mesh.comm, id) == id && id < 1e300)
    for (const Index v : mesh.cell_points[at]) flags[std::size_t(v)] = 1;
  mesh.points.add_to_owners(flags);
  mesh.points.update_ghosts(flags);
  return {flags.begin(), flags.end()};
}

ReportedStress largest(const SolidBody& body, const SolidFields& fields, std::span<const double> points,
                       double mesh_part) {
  const mesh::Mesh& mesh = body.mesh();
  const std::vector<std::uint8_t> wanted = points_of_largest(body, fields, points);
  std::vector<double> left;
  const std::vector<double> stress = fields.point_stress(points, wanted, &left);
  struct Seen {
    double value, left;
    Vec3 place;
  };
  std::vector<Seen> mine;
  for (Index v = 0; v < mesh.points.n_owned(); ++v)
    if (wanted[std::size_t(v)])
      mine.push_back(
          {equivalent_stress(unpack(std::span(stress).subspan(std::size_t(v) * tensor_size, tensor_size))),
           left[std::size_t(v)], body.geometry().points[v]});
  Seen most{-1, std::numeric_limits<double>::quiet_NaN(), Vec3::Zero()};
  for (const Seen& one : parallel::all_gather(mesh.comm, mine))
    if (one.value > most.value) most = one;
  return {"largest", most.place, most.value, larger_of(most.left, mesh_part)};
}

}  // namespace

Vec3 place_of_largest_stress(const SolidBody& body, const SolidFields& fields,
                             std::span<const double> points) {
  return largest(body, fields, points, 0).place;
}

std::vector<ReportedStress> reported_stresses(const SolidBody& body, const SolidFields& fields,
                                              const SolidProbes& probes, double mesh) {
  if (!recovers_stress(body)) return {};
  const std::vector<double> points = fields.point_displacement();
  std::vector<ReportedStress> found;
  for (const SolidProbes::Stress& one : probes.stresses(points))
    found.push_back(
        {fmt::format("at probe '{}'", one.probe), one.place, one.equivalent, larger_of(one.left, mesh)});
  if (!body.is_dynamic()) {
    const ReportedStress most = largest(body, fields, points, mesh);
    if (parallel::comm_rank(body.mesh().comm) == 0 && most.value > 0) found.push_back(most);
  }
  return found;
}

void tell_stresses(MPI_Comm comm, const std::vector<ReportedStress>& stresses) {
  for (const ReportedStress& s : stresses) {
    const bool is_doubtful = s.where != "largest" && s.error > doubtful;
    const std::string error = std::isnan(s.error) ? "unknown"
                              : s.error < 0.995   ? fmt::format("{:.2g} %", 100 * s.error)
                                                  : fmt::format("{:.0f} %", 100 * s.error);
    diagnostics::finding(
        parallel::comm_rank(comm),
        {.id = "stress-error",
         .severity = is_doubtful ? base::Severity::warning : base::Severity::note,
         .number = s.error,
         .limit = doubtful,
         .sentence =
             fmt::format("equivalent stress, {}: {:.4g} Pa at ({:g}, {:g}, {:g}) m, estimated error {}{}",
                         s.where, s.value, s.place[0], s.place[1], s.place[2], error,
                         is_doubtful ? fmt::format(" (limit {:.2g} %): not reliable", 100 * doubtful) : ""),
         .advice = is_doubtful ? "refine the mesh there" : ""});
  }
}

}  // namespace couplet::solid
