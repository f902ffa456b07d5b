// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include <memory>
#include <vector>

#include "common/linalg/matrix.hpp"
#include "common/modes/modal_model.hpp"
#include "common/modes/pencil.hpp"
#include "plate_modal/model/midsurface.hpp"

namespace couplet::plate {

/// Thickness and material of a cell.
struct PlateCell {
  double thickness = 0;       ///< h [m]
  double density = 0;         ///< rho [kg/m^3]
  double youngs_modulus = 0;  ///< [Pa]
  double poissons_ratio = 0;
  double rigidity() const {
    return youngs_modulus * thickness * thickness * thickness / (12 * (1 - poissons_ratio * poissons_ratio));
  }
  double surface_density() const { return density * thickness; }
};

/// K and M of a Kirchhoff plate on one rank, thesis (4.24) with its erratum (inertia rho h). Unknown 3 p + c
/// of point p: deflection, then slopes about axes that are rotated at supported points, so that each support
/// is one row. Supported rows have a one in K and zeros in M.
class PlateModel final {
 public:
  /// `support`: one per patch. Throws Error.
  PlateModel(Midsurface surface, std::vector<PlateCell> cells, const std::vector<Support>& support);

  const Midsurface& surface() const { return surface_; }
  const PlateCell& cell(Index c) const { return cells_[c]; }
  const linalg::SparseMatrix& stiffness() const { return *stiffness_; }
  const linalg::SparseMatrix& mass() const { return *mass_; }
  std::size_t n_unknowns() const { return 3 * surface_.points.size(); }
  bool is_supported(std::size_t unknown) const { return fixed_[unknown]; }

  /// Converts between unknowns and deflection and slopes w, w,x, w,y (3 per point).
  std::vector<double> to_points(std::span<const double> unknowns) const;
  std::vector<double> to_unknowns(std::span<const double> points) const;
  /// Right-hand side of a pressure [Pa], one value per cell, in the direction of positive w.
  std::vector<double> load_of(std::span<const double> pressure) const;
  /// Mean deflection over each cell from w, w,x, w,y at the points.
  std::vector<double> cell_means(std::span<const double> points) const;
  std::vector<double> cell_areas() const;
  /// Order of magnitude of the smallest squared frequency [1/s^2], to start the search.
  double frequency_scale() const;

  /// Lowest modes of the plate.
  modes::EigenModes modes(int n) const;
  /// Solves K u = load for the unknowns. Throws Error if the supports leave the plate free, and SolveFailure.
  std::vector<double> deflect(std::span<const double> load) const;

 private:
  void support_points(const std::vector<Support>& support);
  struct Triplets {
    std::vector<GlobalIndex> row, column;
    std::vector<double> stiffness, mass;
  };
  Triplets assemble() const;
  TriangleMatrix turned(const TriangleMatrix& matrix, const std::array<Index, 3>& points) const;

  Midsurface surface_;
  std::vector<PlateCell> cells_;
  std::vector<Vec2> axis_;  // per point: direction of its second unknown
  std::vector<bool> fixed_;
  std::unique_ptr<linalg::SparseMatrix> stiffness_, mass_;
};

/// Sides of a plate included in its surface.
enum class Wetted { both, upper, lower };

/// Position of the mid-surface in space: origin and axes x and y of its plane; the normal is x cross y.
struct PlateFrame {
  Vec3 origin = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY();
  Vec3 normal() const { return x.cross(y); }
  Vec3 place(const Vec2& p, double height) const {
    return origin + p.x() * x + p.y() * y + height * normal();
  }
};

/// Two-sided surface of a plate and its modes there. A point at height z above the mid-surface moves by w n -
/// z grad w, thesis (4.25). The faces are the upper and lower sides of the cells, and between them one
/// quadrilateral per outline edge whose patch is in `open` (both sides wetted); a clamped edge is inside its
/// wall. The thickness at a point is the area-weighted mean of its cells. Shapes are means over the faces:
/// exact for the cubic deflection on the sides, means of the corners on the rim.
modes::ModalModel skin_of(const PlateModel& plate, const modes::EigenModes& modes,
                          const PlateFrame& placement, Wetted wetted, const std::vector<bool>& open);

}  // namespace couplet::plate
