// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

template <int D>
using Vectors = std::vector<Vec<D>>;

/// Flat view of an array of vectors, for halo updates, output and checkpoints.
template <int D>
std::span<double> flat(Vectors<D>& values) {
  return {values.empty() ? nullptr : values.front().data(), values.size() * D};
}
template <int D>
std::span<const double> flat(const Vectors<D>& values) {
  return {values.empty() ? nullptr : values.front().data(), values.size() * D};
}

/// Geometry of one placement of the points for face loops, per flux face of the mesh (interior faces, then
/// the boundary of owned cells) unless stated otherwise.
template <int D>
struct Placement {
  std::vector<double> volume;  ///< V [m^3], per local cell
  Vectors<D> area;             ///< S [m^2], out of the owner
  /// g = |S|^2/(S.d) [m], over-relaxed; d from the owner to the neighbor (or face) center.
  std::vector<double> conductance;
  Vectors<D> oblique;          ///< k = S - g d [m^2], tangential; empty on orthogonal meshes
  std::vector<double> weight;  ///< of the owner in the linear interpolation to the face, per interior face
  Vectors<D> centre;           ///< per local cell [m]
  std::vector<Vec3> boundary_centre;  ///< per owned boundary face [m]
  double obliqueness = 0;             ///< largest |k|/|S| on this rank
  /// Vector from the interpolation point to the face center, per interior face [m]; empty if not skewed.
  Vectors<D> skew;
  /// Per local cell, with `skew`: matrix B that makes the Gauss gradient G of values at the interpolation
  /// points exact for linear fields: G B for vectors (du_i/dx_j), B^T G for scalars.
  std::vector<Tensor<D>> gradient_cure;
  bool skewed() const { return !skew.empty(); }
  /// Share of the transpose of the pressure's interpolation in the mean flux, per interior face: 1 where sizes jump. There the
  /// pressure could otherwise add energy. 0 where the flux of a mean velocity is exact for linear fields.
  std::vector<double> transposed;
  /// Weight of the owner in the mean flux.
  double flux_weight(Index f) const { return 0.5 + transposed[f] * (0.5 - weight[f]); }
  /// Vector by which the mean flux is corrected: from the midpoint between the cells to the face center where no share is
  /// transposed, skewed meshes only [m].
  Vec<D> offset(Index f) const {
    const Vec<D> whole = skew[f] + (0.5 - weight[f]) / conductance[f] * (area[f] - oblique_of(f));
    return (1 - transposed[f]) * whole;
  }
  /// Shared by placements that are translations of each other; nullptr if unknown.
  std::shared_ptr<const char> shape{};
  /// k of a face [m^2], zero on orthogonal meshes.
  Vec<D> oblique_of(Index face) const { return oblique.empty() ? Vec<D>(Vec<D>::Zero()) : oblique[face]; }
};
/// Correction of a value interpolated linearly between the cells at an interior face of a skewed mesh.
template <int D>
double skew_part(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& gradient, Index f) {
  const double weight = at.weight[f];
  return (weight * gradient[mesh.owner[f]] + (1 - weight) * gradient[mesh.neighbour[f]]).dot(at.skew[f]);
}
/// Limit of |k|/|S| for a mesh to count as orthogonal.
constexpr double orthogonal = 1e-9;

/// Collective.
template <int D>
std::shared_ptr<const Placement<D>> make_placement(const mesh::Mesh& mesh, const mesh::Geometry& geometry);
template <int D>
std::shared_ptr<const Placement<D>> make_placement(const mesh::Mesh& mesh, std::span<const Vec3> points);
/// Translates a placement: only the centers differ. `from` must have a shape.
template <int D>
std::shared_ptr<const Placement<D>> translated(const Placement<D>& from, const Vec3& by);

/// Placement in which values at marked interior faces are means of the cell values, wherever the face lies.
template <int D>
std::shared_ptr<const Placement<D>> in_the_middle(const mesh::Mesh& mesh, const Placement<D>& from,
                                                  std::span<const char> faces);

/// Largest side of the bounding box of points [m]. Collective.
double largest_extent(const mesh::Mesh& mesh, std::span<const Vec3> points);

/// Cell with the largest value over all ranks.
struct LargestCell {
  double value = 0;
  GlobalIndex id = -1;        ///< number in the mesh file; -1 if no rank has a cell
  Vec3 place = Vec3::Zero();  ///< [m]
  int rank = 0;               ///< owner
  Index here = -1;            ///< local number on that rank; -1 elsewhere
};

/// `value`: function of an owned cell; NaN counts as largest. Collective; only `here` differs between ranks.
template <int D, class Value>
LargestCell find_largest(const mesh::Mesh& mesh, const Placement<D>& at, const Value& value) {
  struct {
    double value;
    int rank;
  } worst{-std::numeric_limits<double>::infinity(), parallel::comm_rank(mesh.comm)};
  LargestCell found;
  const int own = worst.rank;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double given = value(c), size = std::isnan(given) ? std::numeric_limits<double>::infinity() : given;
    if (size <= worst.value) continue;
    worst.value = size;
    found.here = c;
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh.comm);
  if (own != worst.rank) found.here = -1;
  double data[4] = {0, 0, 0, -1};
  if (found.here >= 0) {
    for (int d = 0; d < D; ++d) data[d] = at.centre[found.here][d];
    data[3] = static_cast<double>(mesh.cell_id[found.here]);
  }
  MPI_Bcast(data, 4, MPI_DOUBLE, worst.rank, mesh.comm);
  found.value = worst.value;
  found.rank = worst.rank;
  found.place = Vec3(data[0], data[1], data[2]);
  found.id = static_cast<GlobalIndex>(data[3]);
  return found;
}

/// Describes the largest entry of a failed equation: "Its right-hand side is largest, 3e+200, in cell 7 at
/// (0.1, 0.5, 0) m."
inline std::string largest_entry(const LargestCell& of) {
  return fmt::format("Its right-hand side is {}, in cell {} at ({:.6g}, {:.6g}, {:.6g}) m.",
                     std::isfinite(of.value) ? fmt::format("largest, {:.3g}", of.value) : "not finite", of.id,
                     of.place.x(), of.place.y(), of.place.z());
}

// Sums over the interior faces of each cell, compiled for several instruction sets.

/// sum -= factor times the outflow of phi; returns the sum of squares of phi.
double subtract_outflow(const mesh::Mesh& mesh, double factor, std::span<const double> phi,
                        std::span<double> sum);
/// sum += outflow of phi through all faces, including the boundary.
void add_outflow(const mesh::Mesh& mesh, std::span<const double> phi, std::span<double> sum);
/// phi -= factor g (p_N - p_P).
struct FluxCorrection {
  double factor;
  const double* conductance;  ///< g
  double* phi;
};
/// sum += p_f S, p_f linear between the cells. `correction`: computed in the same pass; nullptr for none.
template <int D>
void add_pressure(const mesh::Mesh& mesh, const Placement<D>& at, std::span<const double> p,
                  const FluxCorrection* correction, Vectors<D>& sum);

/// Volume-integrated rates of change of u on a fixed mesh [m^4/s^2], per local cell (ghosts are undefined).
template <int D>
struct Rates {
  Vectors<D> rate;     ///< convection, and the viscous part if it is explicit
  Vectors<D> viscous;  ///< the viscous part if it is implicit, else empty
};

/// Projection pressure at the middle of its step.
template <int D>
struct PressureLevel {
  double time = 0;               ///< t^{n-1/2} [s]
  std::vector<double> p;         ///< per local cell [Pa]
  std::vector<double> boundary;  ///< p_b per boundary face [Pa]
  /// (1/V) sum p_f S per local cell [Pa/m]; only in the latest level (non-orthogonal meshes: two).
  Vectors<D> gradient;
  /// Per lumped end: its pressure above the one given behind it, and at the end of the step with the trapezoidal rule [Pa].
  std::vector<double> ends, ends_end;
  // Compressible fluids only.
  std::vector<double> end;  ///< trapezoidal rule only: p at the end of the step, per local cell [Pa]
  /// Sum of V dp/dt/(rho c^2) over this rank's cells at the end of the step [m^3/s]; not saved.
  double taken_up = 0;
};

/// Outflow beyond the given one at absorbing boundaries, per boundary face: phi/S of outlets and (w -
/// given).n of inlets [m/s], at t^n and t^{n-1}. Per absorbing patch its mean, or the mean pressure of an
/// inlet [Pa].
struct OpeningsState {
  std::vector<double> now, old, mean;
};

/// Circuits behind outlets at t^n and t^{n-1}, per lumped end; of no use for a volume.
struct CircuitsState {
  std::vector<double> flow, flow_old;      ///< out of the fluid, relative to a moving outlet [m^3/s]
  std::vector<double> stored, stored_old;  ///< pressure of the compliance above the one behind it [Pa]
};

/// Start of a flow. A fluid at rest starts with an impulse, whose pressure does not predict later ones.
enum class Start : int { at_rest, after_impulse, flowing };

/// History of a level. A step may reinterpret it (another viscous treatment, a first pressure) without
/// changing the level itself until it is replaced.
template <int D>
struct FlowHistory {
  double time = 0;        ///< t^n [s]
  double dt_old = 0;      ///< size of the last step [s]; 0 means no history, the next step is an Euler step
  bool implicit = false;  ///< the history has an implicit viscous term (Rates::viscous)
  Start start = Start::flowing;
  /// Latest first; nullptr if there is none yet.
  std::array<std::shared_ptr<const PressureLevel<D>>, 3> pressure;
};

/// Kinetic energy and the part of it that no work explains, see EnergyCheck.
struct EnergySums {
  double energy = -1;    ///< at t^n [J]; negative if not known yet
  double largest = 0;    ///< so far [J]
  double excess = 0;     ///< [J]
  double reference = 0;  ///< recent scale for the excess [J]
  double level = 0;      ///< reference pressure for the work at boundaries [Pa]
  double work = 0;       ///< net work done so far [J]
  /// Archives the members in checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(energy, largest, excess, reference, level, work);
  }
  /// False if the energy is at round-off relative to the largest so far.
  bool is_known() const { return energy > 1e-10 * largest && reference > 0; }
};

/// Temperature T, less the reference temperature, at a level and its history. Fluxes of heat are divided by rho c. All is empty
/// without heat.
struct HeatLevel {
  bool is_solved = false;           ///< the same on all ranks
  std::vector<double> temperature;  ///< T^n per local cell, ghosts current [K]
  std::vector<double> boundary;     ///< T^n per boundary face [K]
  std::vector<double> flow;         ///< conducted into the fluid at t^n, per boundary face [K m^3/s]
  /// Sum of the conducted fluxes at t^n, per local cell (ghosts are undefined) [K m^3/s].
  std::vector<double> conduction;
  double received = 0;  ///< stored at the start and received through the boundary since, of this rank [K m^3]
  // At t^{n-1}.
  std::vector<double> temperature_old, boundary_old, flow_old, conduction_old;
  std::vector<double> carried_old;  ///< phi T out of the fluid, per boundary face [K m^3/s]
  std::vector<double>
      convection_old;  ///< -sum phi T of each local cell [K m^3/s]; empty if convection is bounded
  std::vector<double> faces_old, flux_old;  ///< phi T and phi per flux face, bounded convection only
};

/// Complete input of the next step: level n and the history of the multi-step schemes.
template <int D>
struct State : FlowHistory<D> {
  /// Identifies u among all computed states, to avoid recomputing derived data; 0 if not computed.
  std::uint64_t number = 0;
  EnergySums ledger;
  double largest_speed = 0;  ///< of u so far [m/s]

  Vectors<D> u;           ///< u^n per local cell, ghosts current [m/s]
  Vectors<D> w;           ///< given velocity per boundary face at t^n [m/s]
  Vectors<D> u_boundary;  ///< closed boundary velocity at t^n [m/s]
  Vectors<D> turn;        ///< of the walls per boundary face at t^n, see turn_of() [m^2/s]; only with `turns`
  Vectors<D> turn_old;    ///< at t^{n-1}; only with a viscosity law
  bool turns = false;     ///< the same on all ranks
  std::vector<double> phi;                 ///< absolute volume flux per flux face at t^n [m^3/s]
  std::vector<double> memory, memory_old;  ///< delta^n, delta^{n-1} per interior face [m^3/s]

  CircuitsState circuits;  ///< empty without lumped ends
  OpeningsState openings;  ///< empty without absorbing boundaries and a line

  /// Cells in a closed gap, per local cell; nullptr if there are none.
  std::shared_ptr<const std::vector<char>> blocked;

  std::vector<double> eddy;  ///< eddy viscosity at t^n per local cell [m^2/s]; empty without a model
  /// Kinematic viscosity beyond the constant one at t^n per flux face [m^2/s]; empty without a viscosity law.
  std::vector<double> excess;
  std::vector<double> excess_old;  ///< at t^{n-1}

  Vectors<D> u_old, u_boundary_old;  ///< at t^{n-1}
  std::vector<double> phi_old;       ///< at t^{n-1}; empty if convection is explicit everywhere
  Rates<D> rates_old;                ///< at t^{n-1}
  Vectors<D> shear_old;              ///< viscous force on the boundary faces at t^{n-1} [N]

  std::shared_ptr<const Placement<D>> placement;  ///< of the points at t^n
  std::vector<Vec3> points;                       ///< moving mesh only
  std::vector<double> mesh_flux;                  ///< dV_f/dt of the last step [m^3/s], moving mesh only

  HeatLevel heat;
};

/// End of one sub-step.
template <int D>
struct SubStep {
  double dt = 0;                           ///< [s]
  std::shared_ptr<const Placement<D>> to;  ///< of the points at t^{n+1}
  std::vector<double> swept;               ///< dV_f per flux face [m^3]; empty if the mesh is at rest
  std::vector<Vec3> points;                ///< at t^{n+1}; empty if the mesh is at rest
  bool yields = false;                     ///< walls of known mass respond to the pressure (Robin condition)
  /// 1 in cells whose convection is implicit, else 0, per local cell; empty if there are none on any rank.
  std::vector<double> fast{};
};

/// Sub-step with the history at its start, time level n. Constant until the next sub-step.
template <int D>
struct FluidStep : SubStep<D> {
  FlowHistory<D> by;
  /// Pressure that the implicit predictor uses for this step; nullptr if there is none yet.
  std::shared_ptr<const PressureLevel<D>> guess = by.pressure[0];

  double begin() const { return by.time; }
  double middle() const { return by.time + this->dt / 2; }
  double end() const { return by.time + this->dt; }
  bool moving() const { return !this->swept.empty(); }
  /// Ratio of dt to the previous step; 0 if there is none.
  double ratio() const { return by.dt_old > 0 ? this->dt / by.dt_old : 0; }
};

/// Result of the prediction, the first stage of a step.
template <int D>
struct Prediction {
  Vectors<D> w;      ///< given velocities at t^{n+1} per boundary face, as far as known [m/s]
  Vectors<D> u;      ///< u^p per local cell [m/s]
  Vectors<D> force;  ///< f at t^{n+1/2} per local cell [m/s^2]; empty if there is none
  /// Force that the pressure at walls balances in addition to f of their cells, per boundary face at t^{n+1/2} [m/s^2]: R/V of the cell in a
  /// rotating frame, the change of buoyancy from cell to face. Empty without either.
  Vectors<D> beside_walls;
  Vectors<D> viscous_flux;  ///< momentum flux to the surroundings, per boundary face [N]
  double weight = 0;        ///< weight of t^{n+1} in it; 0 with an explicit predictor
  /// Viscosity with which t^{n+1} acts on viscous_flux beyond weight mu, per boundary face [Pa s]; empty without a law.
  std::vector<double> excess;
  Rates<D> rates;    ///< R^n
  Vectors<D> shear;  ///< viscous force on the boundary faces at t^n [N]
};

/// Result of the projection, the second stage.
template <int D>
struct Projected {
  std::vector<double> p, boundary;  ///< per local cell, per boundary face [Pa]
  std::vector<double> phi;          ///< phi^p per flux face, without the last pressure correction [m^3/s]
  Vectors<D> w;  ///< given velocities at t^{n+1}, including responses of walls and openings [m/s]
  /// Gradient of p in the non-orthogonal part, per local cell [Pa/m]; empty on orthogonal meshes.
  Vectors<D> gradient;
  /// Pressure per local cell that the friction of the projection adds [Pa], see PressureProjection; empty if there is none.
  std::vector<double> rotational;
};

/// Writes a complete state, including history, bit for bit. Collective.
template <int D>
void write_state(io::CheckpointWriter& file, const State<D>& state);
/// `at_rest`: placement of a mesh at rest; nullptr if the file has the points. Throws Error if the file does
/// not fit the mesh. `has_heat`: the temperature is read as well. Collective.
template <int D>
State<D> read_state(io::CheckpointReader& file, const mesh::Mesh& mesh,
                    std::shared_ptr<const Placement<D>> at_rest, bool has_heat = false);

/// Three cells in a row. The middle one is owned; its two faces are parallel and normal to the line of cells.
struct CellTriple {
  Index before, cell, after;
  Index face;                        ///< one of the two, with S pointing from `before` to `after`
  int axis = -1;                     ///< axis parallel to S; -1 if there is none
  double g_before = 0, g_after = 0;  ///< conductances of the two faces [m]
};

/// Links of a mesh at rest, in the order of their cells.
template <int D>
struct Lines {
  std::vector<CellTriple> links;
  double share = 0;  ///< fraction of links among the cells and directions of the whole mesh

  /// Collective.
  Lines(const mesh::Mesh& mesh, const Placement<D>& at);
  /// Placement for the fourth-order operators: the face value is the mean of two cells if both have a link
  /// across the face. Collective.
  std::shared_ptr<const Placement<D>> seen(const mesh::Mesh& mesh, const Placement<D>& at) const;
};

/// Corrections by links to the second-order operators (docs/theory/fluid-models.md). D is the second
/// difference of a link, U its flux velocity times S.
template <int D>
class FourthOrder {
 public:
  FourthOrder(const mesh::Mesh& mesh, Lines<D> lines) : mesh_(mesh), lines_(std::move(lines)) {}

  /// Adds to the rate of convection and friction (none if nu = 0) of a state. Collective.
  void add_rates(const State<D>& state, double nu, Vectors<D>& rate) const;
  /// u - n (n.Du)/6 over the links of each cell, ghosts current; its means are the fluxes. Collective.
  const Vectors<D>& flux_velocity(const Placement<D>& at, const Vectors<D>& u);
  /// Applies the transpose to a pressure gradient: g - n (n.D(V g))/(6 V). Collective.
  void sharpen(const Placement<D>& at, Vectors<D>& gradient) const;
  /// mu sum (g_1 x - g_2 y)^2/(g_1 + g_2)/6, the contribution to viscous dissipation on this rank [W].
  double dissipation(double mu, const Vectors<D>& u) const;
  double share() const { return lines_.share; }

 private:
  const mesh::Mesh& mesh_;
  Lines<D> lines_;
  Vectors<D> flux_velocity_;
};

}  // namespace couplet::fluid
