// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "common/elasticity/vector_at.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/diagnostics/neglected.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {
namespace {

/// Faces of the body that pass through each other: the depth of displaced boundary points in displaced cells that are not their
/// neighbors.
class MissingContact final : public diagnostics::Diagnostic {
 public:
  explicit MissingContact(const SolidView& view) : view_(view) {}
  void look(diagnostics::Report& report) override {
    const double share = depth_over_motion();
    if (!(share > 0)) return;
    add(report,
        diagnostics::finding_of(
            {.effect = "contact",
             .number = share,
             .what =
                 fmt::format("faces pass through each other by {:.2g} of the largest displacement", share),
             .advice =
                 "contact between bodies is not modeled: keep the faces apart, or end the loads before they touch",
             .share = std::min(share, 1.)}));
  }

 private:
  struct Place {
    double x, y, z;
    GlobalIndex point;
    Vec3 at() const { return {x, y, z}; }
  };

  double depth_over_motion() const {
    const mesh::Mesh& mesh = view_.body.mesh();
    const std::vector<double> u = view_.fields.point_displacement();
    std::vector<Vec3> moved = view_.body.geometry().points;
    double motion = 0, rounding = 0;
    for (std::size_t v = 0; v < moved.size(); ++v) {
      const Vec3 here = elastic::vector_at(u, Index(v), mesh.dim);
      moved[v] += here;
      rounding = std::max(rounding, std::numeric_limits<double>::epsilon() * moved[v].norm());
      if (Index(v) < mesh.points.n_owned()) motion = std::max(motion, here.norm());
    }
    motion = parallel::max(mesh.comm, motion);
    std::vector<std::uint8_t> outside(moved.size(), 0);
    for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
      if (mesh.twin.empty() || mesh.twin[std::size_t(f - mesh.n_interior)] < 0)
        for (const Index v : mesh.face_points[f]) outside[std::size_t(v)] = 1;
    std::vector<Place> mine;
    for (Index v = 0; v < Index(moved.size()); ++v)
      if (outside[std::size_t(v)]) mine.push_back({moved[v][0], moved[v][1], moved[v][2], mesh.point_id[v]});
    std::vector<Place> places = parallel::all_gather(mesh.comm, mine);
    std::ranges::sort(places, {}, &Place::x);
    const mesh::Csr cells_of_point = mesh::transpose(mesh.cell_points, 0, mesh.points.n_local());
    mesh::Csr cells_of_face;
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      const std::array<Index, 2> sides{mesh.owner[f], f < mesh.n_interior ? mesh.neighbour[f] : -1};
      cells_of_face.push_row({sides.data(), std::size_t(f < mesh.n_interior ? 2 : 1)});
    }
    const mesh::Csr faces_of_cell = mesh::transpose(cells_of_face, 0, mesh.cells.n_local());
    const auto is_near = [&](Index cell, GlobalIndex point) {
      for (const Index v : mesh.cell_points[cell])
        for (const Index c : cells_of_point[v])
          for (const Index w : mesh.cell_points[c])
            if (mesh.point_id[w] == point) return true;
      return false;
    };
    double depth = 0;
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
      if (std::ranges::none_of(faces_of_cell[c], [&](Index f) { return f >= mesh.n_interior; })) continue;
      Vec3 low = Vec3::Constant(1e300), high = -low, middle = Vec3::Zero();
      for (const Index v : mesh.cell_points[c]) {
        low = low.cwiseMin(moved[v]), high = high.cwiseMax(moved[v]);
        middle += moved[v] / double(mesh.cell_points[c].size());
      }
      for (auto p = std::ranges::lower_bound(places, low[0], {}, &Place::x);
           p != places.end() && p->x < high[0]; ++p) {
        if ((p->at() - low).minCoeff() < 0 || (high - p->at()).minCoeff() < 0 || is_near(c, p->point))
          continue;
        double here = std::numeric_limits<double>::max();
        bool is_inside = true;
        for (const Index f : faces_of_cell[c]) {
          const double away = inward(mesh.face_points[f], moved, middle, p->at());
          is_inside = is_inside && away > 0;
          if (f >= mesh.n_interior) here = std::min(here, away);
        }
        if (is_inside) depth = std::max(depth, here);
      }
    }
    depth = parallel::max(mesh.comm, depth);
    return depth > parallel::max(mesh.comm, rounding) ? depth / motion : 0;
  }

  /// Distance of a place from the plane of a face, on the side of `middle`.
  static double inward(std::span<const Index> points, const std::vector<Vec3>& moved, const Vec3& middle,
                       const Vec3& at) {
    const Vec3 along = moved[points[1]] - moved[points[0]];
    const Vec3 normal = points.size() == 2
                            ? Vec3(along[1], -along[0], 0)
                            : Vec3((moved[points[points.size() - 1]] - moved[points[1]])
                                       .cross(moved[points[points.size() / 2]] - moved[points[0]]));
    const double side = normal.dot(middle - moved[points[0]]);
    return normal.dot(at - moved[points[0]]) / normal.norm() * (side < 0 ? -1 : 1);
  }

  SolidView view_;
};

}  // namespace

diagnostics::Made missing_contact(const SolidView& view) { return std::make_shared<MissingContact>(view); }

}  // namespace couplet::solid
