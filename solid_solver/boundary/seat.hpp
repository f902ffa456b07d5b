// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "common/contact/contact.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Faces that may touch a rigid frictionless seat, thesis (4.32)-(4.33). The penetration of a face is the
/// mean of its trace. The same trial functions distribute its force to the rows, so a flat-pressed body has a
/// uniform stress. Faces, places and areas are undeformed; a plane remains a plane at large strain.
class Seat final {
 public:
  /// `open`: boundary faces of owned cells with only a force condition. K and h of [thesis, equation 4.33] are
  /// the constrained modulus and depth of the cell behind the face. `kernel`: kernel of the symmetric gradient, kept by
  /// reference. Throws Error if no face is oriented towards the seat. Collective.
  Seat(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, const elastic::ElasticKernel& kernel,
       const contact::ContactParameters& parameters, std::span<const std::uint8_t> open, bool is_static);

  struct Face {
    Index face;
    Vec3 centre;
    double gap;    ///< at rest [m]
    double kappa;  ///< [N/m]
    double area;   ///< projected on the direction [m^2]
  };
  const std::vector<Face>& faces() const { return faces_; }  ///< of this rank
  std::size_t size() const { return faces_.size(); }
  bool is_conserving() const { return is_conserving_; }
  /// True without penetration (static analysis, no given stiffness). `kappa` only helps to find the pressure.
  bool is_rigid() const { return is_rigid_; }
  /// Displacement along the direction for `values` of unknowns and known columns (empty means zeros). Collective.
  std::vector<double> along(std::span<const double> unknowns, std::span<const double> known) const;
  /// Penetration [m]; not positive if the face is clear of the seat. Collective.
  std::vector<double> penetration(std::span<const double> unknowns, std::span<const double> known) const;
  /// Adds these forces along the direction [N] to rows. Collective.
  void add_to_rows(std::span<const double> forces, std::span<double> rows) const;
  /// Adds the forces to faces, `dim` values per boundary face of owned cells.
  void add_to_faces(std::span<const double> forces, std::span<double> faces) const;

  struct Look {
    double force = 0;        ///< along the direction [N]
    double penetration = 0;  ///< largest [m]
    double energy = 0;       ///< stored in the seat [J]
    double pressure = 0;     ///< largest [Pa]
    double area = 0;         ///< of the faces in contact [m^2]
  };
  /// `forces`: forces of a rigid seat; empty to use the spring forces. Collective.
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

/// Response of a seat in one solve. The unknown w gives the penetration delta = base - factor d . w of each
/// face. It is that at the end of the step (conserving rule: work equals energy), or where the scheme has its
/// equilibrium. A rigid seat (static, no stiffness) uses multipliers lambda [powell1969] in kappa <delta +
/// lambda/kappa>, updated to that force until delta vanishes.
class Pressing final {
 public:
  /// `before`: penetrations at the start of the step; empty if the force depends only on delta.
  Pressing(const Seat& seat, double factor, std::vector<double> base, std::vector<double> before)
      : seat_(seat),
        factor_(factor),
        base_(std::move(base)),
        before_(std::move(before)),
        multiplier_(seat.size(), 0),
        force_(multiplier_),
        stiffness_(multiplier_) {}

  const Seat& seat() const { return seat_; }
  /// Computes forces and their tangent for w with this motion along the direction (Seat::along()).
  void look(std::span<const double> along);
  /// Calls look() at w of these unknowns and known columns, and adds the forces to rows. Collective.
  void push_off(std::span<const double> unknowns, std::span<const double> known, std::span<double> rows);
  /// Repelling forces of the last look() [N] and their increase with motion towards the seat [N/m].
  const std::vector<double>& forces() const { return force_; }
  const std::vector<double>& stiffness() const { return stiffness_; }
  /// Sets the multipliers to the forces of the last look(). Returns the largest relative change. Collective.
  double take_multipliers(MPI_Comm comm);
  /// Adds the stiffness of the last look() times v to rows. Collective.
  void add_stiffness(std::span<const double> v, std::span<double> rows) const;

 private:
  const Seat& seat_;
  double factor_;
  std::vector<double> base_, before_;
  std::vector<double> multiplier_, force_, stiffness_;
};

}  // namespace couplet::solid
