// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "common/contact/contact.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// The faces that may meet a rigid seat without friction, thesis (4.32)-(4.33). The penetration of a face is that of the mean of
/// its trace, whose trial functions also take its force to the rows: pressed flat, a body has the uniform stress of a traction.
/// Faces, places and areas are those of the undeformed body; a plane stays one at large strain.
class Seat final {
 public:
  /// `open`: boundary faces of owned cells on which the force alone is known. K and h of (4.33): the modulus of compression between
  /// walls of the cell behind the face, and its depth. `kernel`: by reference, of the symmetric gradient. Throws Error if no
  /// face looks at the seat. Collective.
  Seat(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, const elastic::ElasticKernel& kernel,
       const contact::ContactParameters& parameters, std::span<const std::uint8_t> open, bool is_static);

  struct Face {
    Index face;
    Vec3 centre;
    double gap;    ///< at rest [m]
    double kappa;  ///< [N/m]
    double area;   ///< across the direction [m^2]
  };
  const std::vector<Face>& faces() const { return faces_; }  ///< of this rank
  std::size_t size() const { return faces_.size(); }
  bool is_conserving() const { return is_conserving_; }
  /// Keeps the body out altogether: static analyses without a given stiffness. `kappa` only helps to find its pressure.
  bool is_rigid() const { return is_rigid_; }
  /// Motion along the direction, of `values` of the operator's unknowns and known columns (empty: zeros). Collective.
  std::vector<double> along(std::span<const double> unknowns, std::span<const double> known) const;
  /// Below the seat [m]: not above 0 where the face is clear of it. Collective.
  std::vector<double> penetration(std::span<const double> unknowns, std::span<const double> known) const;
  /// rows += forces of so much along the direction [N]. Collective.
  void add_to_rows(std::span<const double> forces, std::span<double> rows) const;
  /// faces += the same, `dim` values a boundary face of owned cells.
  void add_to_faces(std::span<const double> forces, std::span<double> faces) const;

  struct Look {
    double force = 0;        ///< along the direction [N]
    double penetration = 0;  ///< the deepest [m]
    double energy = 0;       ///< kept in the seat [J]
    double pressure = 0;     ///< the largest [Pa]
    double area = 0;         ///< of the faces that touch [m^2]
  };
  /// `forces`: of a rigid seat, empty: the springs' own. Collective.
  Look look(std::span<const double> penetration, std::span<const double> forces) const;

 private:
  void refuse_start_inside() const;

  const mesh::Mesh& mesh_;
  const elastic::ElasticKernel& kernel_;
  Vec3 direction_;
  bool is_conserving_, is_rigid_;
  std::vector<Face> faces_;
  std::vector<Index> numbers_;  // of the faces
};

/// How a seat answers in one solve. What is solved for, w, shows the penetration delta = base - factor d . w on each face:
/// at the end of the step, whose work is that of its energy (conserving rule), or where the scheme has its equilibrium.
/// A rigid seat (static analyses without a stiffness) has its pressure from multipliers lambda [powell1969]:
/// kappa <delta + lambda / kappa>, lambda taking that force again and again until delta vanishes.
class Pressing final {
 public:
  /// `before`: penetrations at the start of the step, empty: force of delta itself.
  Pressing(const Seat& seat, double factor, std::vector<double> base, std::vector<double> before)
      : seat_(seat),
        factor_(factor),
        base_(std::move(base)),
        before_(std::move(before)),
        multiplier_(seat.size(), 0),
        force_(multiplier_),
        stiffness_(multiplier_) {}

  const Seat& seat() const { return seat_; }
  /// Forces and their tangent for w of this motion along the direction (Seat::along()).
  void look(std::span<const double> along);
  /// look() at w of these unknowns and known columns; rows += the forces. Collective.
  void push_off(std::span<const double> unknowns, std::span<const double> known, std::span<double> rows);
  /// Of the last look() [N], pushing off, and what they grow by with a motion towards the seat [N/m].
  const std::vector<double>& forces() const { return force_; }
  const std::vector<double>& stiffness() const { return stiffness_; }
  /// The multipliers become the forces of the last look(). Gives the largest change over the largest force. Collective.
  double take_multipliers(MPI_Comm comm);
  /// rows += the stiffness of the last look() on v. Collective.
  void add_stiffness(std::span<const double> v, std::span<double> rows) const;

 private:
  const Seat& seat_;
  double factor_;
  std::vector<double> base_, before_;
  std::vector<double> multiplier_, force_, stiffness_;
};

}  // namespace couplet::solid
