// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/finite/stress_stiffness.hpp"
#include "common/mesh/mesh.hpp"
#include "common/modes/modal_model.hpp"
#include "common/modes/pencil.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// K of free vibrations; empty if the kernel has no mass. Keeps a reference to `body`.
std::optional<SolidProblem> vibration(const SolidBody& body);

/// Lowest n free vibrations of the supported body, K x = omega^2 M x with stiffness and mass of the kernel.
/// Uses shift-invert with the solution method of a time step. Supports and springs count, prescribed motions
/// are held at rest. `problem`: static problem with a kernel that has mass (face-gradient: symmetric, dynamic
/// analysis). `cell_mass`: mass of each owned cell [kg]. Shapes are mass-normalized, on this rank's unknowns. Throws
/// SolveFailure. Collective.
modes::EigenModes solid_modes(const SolidProblem& problem, MethodParameters method,
                              std::span<const double> cell_mass, int n);

/// Bound of the relative error of each frequency above 0 due to the mesh: half that of the strain energy of its
/// mass-normalised shape. Face strains and recovered ones differ by a strain g and by the energy g^2, which falls faster
/// with the cell size than the error of the frequencies: the larger of this energy and of a share of g counts. Collective.
std::vector<double> mode_errors(const SolidBody& body, const modes::EigenModes& modes);

/// Surface values of these modes on rank 0 (empty elsewhere), vertices by ascending point_id and faces by
/// ascending boundary_id. A plane body has a depth of 1 m and a third component of 0. Collective.
modes::ModalModel modal_model(const SolidProblem& problem, const modes::EigenModes& modes);

/// Prestress of the linear solution in `fields` with the tangent of the loads at `time`. Pressures follow the
/// surface, and they and body forces are those of the place to which the body moves. A body force without
/// potential (b_y = f(x)) belongs to the body, and tractions and forces keep their direction. So do the forces of a partner,
/// SolidStepper::last_solve().interface, except for their even pressure. Collective.
elastic::Prestress prestress_of(const SolidBody& body, const SolidFields& fields, double time,
                                std::span<const double> interface = {});

/// Largest compression in it [Pa], at least 0. Collective.
double compression(const mesh::Mesh& mesh, const elastic::Prestress& prestress);

/// (K + lambda K_sigma) x = 0: lambda times the loads make the linear equilibrium neutral.
struct Buckling {
  std::vector<double> factor;  ///< lambda above 0, ascending; empty if these loads cause no buckling
  std::vector<std::vector<double>> shape;  ///< x on the rows of ElasticOperator, largest component 1
};

/// Finds the lowest `n` factors, or all if fewer. Counting negative pivots of K + s K_sigma, s above the
/// last, ensures that none is missed. `body`: static, symmetric gradient. Throws SolveFailure. Collective.
Buckling find_buckling(const SolidBody& body, const elastic::Prestress& prestress, int n);

/// Lowest n free vibrations about the loaded equilibrium, (K + K_sigma) x = omega^2 M x. Sets the density of
/// the kernel. Throws SolveFailure, also for an unstable equilibrium. Collective.
modes::EigenModes preloaded_modes(const SolidBody& body, const elastic::Prestress& prestress, int n);

/// Sentence about the shapes that planes of symmetry exclude from modes and buckling; empty without such planes.
std::string missing_shapes(const SolidBody& body);

/// y = A x on the packed rows of this rank (owned cells, then unknown faces). Collective.
using ElasticApplication = std::function<void(std::span<const double> x, std::span<double> y)>;

/// Largest number of cell displacement components for a spectrum, because the matrix is dense.
constexpr GlobalIndex largest_spectrum = 4000;

/// Eigenvalues of M^-1 K [1/s^2], ascending real part. K is A with massless faces eliminated, M contains
/// `cell_mass`, one per owned cell [kg]. On rank 0, empty elsewhere. Throws Error beyond largest_spectrum.
/// Collective.
std::vector<std::complex<double>> spectrum(const mesh::Mesh& mesh, std::span<const double> cell_mass,
                                           std::size_t n_unknowns, const ElasticApplication& apply);

/// Eigenvalues of a symmetric pair, M applied like A: real, ascending. Massless rows are eliminated.
/// Collective.
std::vector<std::complex<double>> symmetric_spectrum(const mesh::Mesh& mesh, std::size_t n_unknowns,
                                                     const ElasticApplication& stiffness,
                                                     const ElasticApplication& mass);

/// Eigenvalues of a body, see above. Collective.
std::vector<std::complex<double>> eigenvalues(const SolidBody& body);

}  // namespace couplet::solid
