// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/pressure/pressure.hpp"

namespace couplet::fluid {

namespace {

// Tolerance of the responses, whose errors appear in the balance of the ends.
constexpr double response_tolerance = 1e-10;
// Solves of one response on a mesh at rest, until one needs no iteration. A restart from it then changes no bit. On a moving mesh every
// sub-step has a solve, which a restart repeats.
constexpr int most_response_solves = 4;
// Limit over the faces' conductance. Cells that follow the pressure of an end this closely are ignored.
constexpr double least_answer = 1e-9;
// Tolerance of the equation that the known pressures allow, over what they are in it: rounding of the guess, reduced further.
constexpr double known_rounding = 1e-20;
// The same over the changes of these pressures in the step, if the response to them is known exactly.
constexpr double change_rounding = 1e-15;
// Flow rate by which a point of a table may be missed, over the largest flow rate of the table.
constexpr double point_rounding = 1e-12;

/// Rank of an end: its pressure p, its flow Q out of the fluid at t^{n+1}, and r p - k Q = s. r = 0 prescribes the flow.
struct EndLaw {
  double r = 1, k = 0, s = 0;
};

/// Pressure p of a circuit above the one behind it, which is linear in the flow q at t^{n+1/2}: p = impedance q + known.
struct CircuitLaw {
  double impedance = 0, known = 0;
};

/// Lumped ends, one unknown pressure each, at once with the cells. With the conductances G_i of the faces of end i, the equation
/// of the cells is A p = b + sum_j G_j p_j. The responses Y_i of A Y_i = G_i give the flows before p is known, as A is symmetric:
///   Q_i = F_i + (dt/rho) Y_i.b - (dt/rho) sum_j S_ij p_j,    S_ij = delta_ij |G_i| - G_i.Y_j
/// Here F_i is the flow that the prediction and the given pressures leave. S is symmetric and positive semi-definite, and an end's
/// pressure does not fall with its flow, so that the small system of all ends has one solution for any step.
///   volume    rate p + past = rho c^2/V_0 (Q + given), see WaveRule
///   circuit   p = Z q,   C dp_d/dt = q - p_d/R_d,   p = R_p q + p_d,   or p = f(q)
/// q and p_d at t^{n+1/2} follow from three levels by middle_weights(): second order, and what a step does not resolve decays.
template <int D>
class LumpedEnds final : public Term<D> {
 public:
  LumpedEnds(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction)
      : Term<D>(scene, step, prediction),
        ends_(scene.boundary.ends()),
        trapezoidal_(scene.is_compressible() &&
                     scene.parameters.compressibility->scheme == WaveScheme::trapezoidal),
        pressure_(ends_.size(), 0.0) {
    std::vector<char> of_end(scene.boundary.rows().pressure.size(), 0);
    for (const LumpedEnd& end : ends_)
      for (const auto& [first, count] : end.faces) std::fill_n(of_end.begin() + first, count, 1);
    const bool others = std::ranges::any_of(scene.boundary.rows().of_pressure,
                                            [&](Index b) { return of_end[std::size_t(b)] == 0; });
    const FluidParameters& p = scene.parameters;
    alone_ = !parallel::any(mesh_.comm, others) && !scene.is_compressible() && !scene.boundary.yields() &&
             p.bodies.empty() && p.gaps.empty();
  }

  void prepare(const State<D>& from) override {
    before_ = &from.circuits;
    weight_ = middle_weights(step_.dt, step_.by.dt_old);
    stored_weight_ = step_.by.dt_old > 0 ? weight_ : std::array{0.5, 0.5, 0.};
    laws_.assign(ends_.size(), EndLaw());
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      pressure_[i] = last(i);
      if (ends_[i].volume > 0) laws_[i] = law_of_volume(from, i);
    }
  }
  bool is_in_matrix() const override { return false; }
  double version() const override { return 1; }
  /// Solves for the responses.
  void respond(PressureEquation<D>& equation) override {
    const Placement<D>& at = scene_.around(step_);
    const std::size_t n = ends_.size();
    response_.resize(n);
    std::vector<double> sums(n + n * n, 0.0);  // |G_i|, G_i.Y_j
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double>& y = response_[i];
      y.resize(mesh_.cells.n_local(), 0.0);
      if (alone_ && i + 1 == n) {  // a uniform pressure of all ends is that of the fluid
        std::ranges::fill(y, 1.0);
        for (std::size_t j = 0; j < i; ++j)
          for (std::size_t c = 0; c < y.size(); ++c) y[c] -= response_[j][c];
        break;
      }
      std::vector<double> side(mesh_.cells.n_owned(), 0.0);
      for_faces(i, [&](Index, Index f) { side[mesh_.owner[f]] += at.conductance[f]; });
      for (int k = 0; k < (step_.moving() ? 1 : most_response_solves); ++k)
        if (equation.solve(at, side, y, response_tolerance, std::numeric_limits<double>::min()).iterations ==
            0)
          break;
      for (std::size_t c = 0; c < side.size(); ++c) sums[n + n * i + i] += y[c] * side[c];
    }
    for (std::size_t i = 0; i < n; ++i)
      for_faces(i, [&](Index, Index f) {
        sums[i] += at.conductance[f];
        for (std::size_t j = 0; j < n; ++j)
          if (i != j) sums[n + n * i + j] += at.conductance[f] * response_[j][mesh_.owner[f]];
      });
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
    faces_.assign(sums.begin(), sums.begin() + std::ptrdiff_t(n));
    admittance_.setZero(Index(n), Index(n));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        const double mean = 0.5 * (sums[n + n * i + j] + sums[n + n * j + i]);
        admittance_(Index(i), Index(j)) = i == j ? faces_[i] - mean : -mean;
      }
    for (Index i = 0; alone_ && i < Index(n); ++i)
      admittance_(i, i) -= admittance_.row(i).sum();  // rows sum to zero to the last bit
  }
  /// The pressure at the faces of a volume is zero until it is known.
  void foresee(const State<D>&, Projected<D>& out) override {
    for (std::size_t i = 0; i < ends_.size(); ++i)
      if (ends_[i].volume > 0) for_faces(i, [&](Index b, Index) { out.boundary[b] = 0; });
  }
  /// Solves for the pressures of the ends, and sets them at their faces.
  void before(Projected<D>& out, RightSide& side) override {
    const Placement<D>& at = scene_.around(step_);
    const double factor = step_.dt / scene_.fluid.rho;
    std::vector<double> flux(ends_.size() + 1, 0.0);  // flow of each end without its pressure; |b|^2
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      for_faces(i, [&](Index b, Index f) {
        const double given = ends_[i].volume > 0 ? out.w[b].dot(step_.to->area[f]) : swept(f);
        flux[i] += out.phi[f] - given - factor * at.conductance[f] * out.boundary[b];
      });
      for (std::size_t c = 0; c < side.b.size(); ++c) flux[i] += factor * response_[i][c] * side.b[c];
    }
    if (side.size < 0)
      for (const double b : side.b) flux.back() += b * b;
    MPI_Allreduce(MPI_IN_PLACE, flux.data(), int(flux.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
    solve(flux, factor);
    side.ends.resize(ends_.size(), 0.0);
    double squares[3] = {};  // in b: of the pressures of circuits, of their changes, of changes of volumes
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      const bool is_volume = ends_[i].volume > 0;  // its pressure stays in b, whose size is that of changes
      const double p = pressure_[i], change = p - last(i);
      for_faces(i, [&](Index b, Index f) {
        const double g = at.conductance[f];
        out.boundary[b] += p;
        if (is_volume)
          side.b[mesh_.owner[f]] += g * p;
        else
          squares[0] += g * p * g * p;
        squares[is_volume ? 2 : 1] += std::pow(g * change, 2);
      });
      if (is_volume) continue;
      side.known.resize(mesh_.cells.n_local(), 0.0);
      for (std::size_t c = 0; c < side.known.size(); ++c) {
        side.known[c] += p * response_[i][c];
        out.p[c] -= side.ends[i] * response_[i][c];
      }
    }
    side.ends = pressure_;
    MPI_Allreduce(MPI_IN_PLACE, squares, 3, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    side.size = std::hypot(side.size < 0 ? std::sqrt(flux.back()) : side.size, std::sqrt(squares[2]));
    side.floor = known_rounding * std::sqrt(squares[0]) +
                 (alone_ && ends_.size() == 1 ? change_rounding : response_tolerance) * std::sqrt(squares[1]);
  }
  void complete(PressureLevel<D>& level) const override {
    level.ends = pressure_;
    if (!trapezoidal_) return;
    level.ends_end = pressure_;
    for (std::size_t i = 0; step_.by.pressure[0] && i < ends_.size(); ++i)
      level.ends_end[i] = 2 * pressure_[i] - begin(i);
  }
  /// Sets state.circuits.
  void commit(const Projected<D>& out, State<D>& s) const override {
    CircuitsState& c = s.circuits;
    const std::vector<double> now = flows([&](Index f) { return out.phi[f] - swept(f); });
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      const double q = weight_[0] * now[i] + past_flow(c, i);
      double stored = 0;
      if (const auto& w = ends_[i].circuit.windkessel)
        stored = (w->compliance / step_.dt * c.stored[i] + q - past_stored(c, i) / w->distal) / storage(*w);
      c.stored_old[i] = std::exchange(c.stored[i], stored);
    }
    c.flow_old = std::exchange(c.flow, now);
    if (weight_[0] == 1) c.flow_old = c.flow;  // what an Euler step has damped stays so
  }
  /// A volume takes the pressure of its faces.
  void start(const Placement<D>& at, PressureLevel<D>& level) const override {
    level.ends.assign(ends_.size(), 0.0);
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      if (ends_[i].volume == 0) continue;
      double sums[2] = {};
      for_faces(i, [&](Index b, Index f) {
        const double area = at.area[f].norm();
        sums[0] += area * level.boundary[b], sums[1] += area;
      });
      MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
      level.ends[i] = sums[0] / sums[1];
    }
  }
  void start(State<D>& s) const override {
    CircuitsState& c = s.circuits;
    c.flow = flows([&](Index f) { return s.phi[f]; });
    c.stored.clear();
    for (const LumpedEnd& end : ends_)
      c.stored.push_back(end.circuit.windkessel ? end.circuit.windkessel->initial_pressure : 0);
    c.flow_old = c.flow, c.stored_old = c.stored;
  }
  /// The responses are the guess for the next ones, so those of the accepted level are stored.
  void accept() override { accepted_ = response_; }
  void visit(io::Archive& archive) override {
    accepted_.resize(ends_.size());
    for (std::size_t i = 0; i < ends_.size(); ++i)
      archive.field(mesh::Entries::cells, fmt::format("end-response-{}", i), accepted_[i], 1);
    if (archive.reads()) response_ = accepted_;
  }

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;

  /// Calls `use` with the boundary index and the index of each face of an end.
  template <class Use>
  void for_faces(std::size_t i, const Use& use) const {
    for (const auto& [first, count] : ends_[i].faces)
      for (Index b = first; b < first + count; ++b) use(b, mesh_.n_interior + b);
  }
  /// Sum of a flux over the faces of each end. Collective.
  template <class Flux>
  std::vector<double> flows(const Flux& flux) const {
    std::vector<double> sums(ends_.size(), 0.0);
    for (std::size_t i = 0; i < sums.size(); ++i) for_faces(i, [&](Index, Index f) { sums[i] += flux(f); });
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
    return sums;
  }
  /// Flux that a moving face sweeps [m^3/s].
  double swept(Index f) const { return step_.swept.empty() ? 0 : step_.swept[f] / step_.dt; }
  double last(std::size_t i) const { return step_.by.pressure[0] ? step_.by.pressure[0]->ends[i] : 0; }
  double begin(std::size_t i) const {
    const PressureLevel<D>& level = *step_.by.pressure[0];
    return level.end.empty() ? level.ends[i] : level.ends_end[i];
  }
  // Parts of earlier levels in values at t^{n+1/2}.
  double past_flow(const CircuitsState& c, std::size_t i) const {
    return weight_[1] * c.flow[i] + weight_[2] * c.flow_old[i];
  }
  double past_flow(std::size_t i) const { return past_flow(*before_, i); }
  double past_stored(const CircuitsState& c, std::size_t i) const {
    return stored_weight_[1] * c.stored[i] + stored_weight_[2] * c.stored_old[i];
  }
  /// Factor of p_d at t^{n+1} in the equation of a compliance.
  double storage(const WindkesselParameters& w) const {
    return w.compliance / step_.dt + stored_weight_[0] / w.distal;
  }

  /// Law of a volume V_0 at rest: dp/dt = rho c^2 (Q + given)/V_0 with the prescribed flow into it.
  EndLaw law_of_volume(const State<D>& from, std::size_t i) const {
    const double rate = wave_rate(step_, trapezoidal_);
    const double stiffness = scene_.fluid.rho * scene_.fluid.sound * scene_.fluid.sound / ends_[i].volume;
    double past = 0;
    if (rate > 0 && trapezoidal_) {
      double given = 0, flow = 0;  // into the volume, out of it
      for_faces(i, [&](Index b, Index f) {
        given -= from.w[b].dot(from.placement->area[f]);
        flow -= from.phi[f];
      });
      past =
          -rate * begin(i) - stiffness * (parallel::sum(mesh_.comm, given) - parallel::sum(mesh_.comm, flow));
    } else if (rate > 0) {
      const WaveRule rule = wave_rule(step_);
      for (std::size_t k = 0; k < rule.past.size(); ++k)
        if (rule.past[k] != 0) past += rule.past[k] * step_.by.pressure[k]->ends[i];
    }
    return {rate, stiffness, -past};
  }
  /// `piece`: of a table.
  CircuitLaw law_of_circuit(std::size_t i, std::size_t piece) const {
    const CircuitParameters& circuit = ends_[i].circuit;
    if (circuit.resistance) return {*circuit.resistance, 0};
    if (const auto& w = circuit.windkessel) {
      const double share = stored_weight_[0] / storage(*w), past = past_stored(*before_, i);
      return {w->proximal + share,
              past + share * (w->compliance / step_.dt * before_->stored[i] - past / w->distal)};
    }
    const std::vector<double>&q = ends_[i].drop->table()->at(), &p = ends_[i].drop->table()->values();
    if (piece == 0 || piece == q.size()) return {0, piece == 0 ? p.front() : p.back()};
    const double slope = (p[piece] - p[piece - 1]) / (q[piece] - q[piece - 1]);
    return {slope, p[piece] - slope * q[piece]};
  }

  /// Sets the pressures of all ends for given flows without them. A table is linear between its points. From the last flow on, the
  /// solution of the present pieces is approached until a table leaves its piece [katzenelson1965], which ends after finitely
  /// many pieces, because no pressure falls with its flow.
  void solve(const std::vector<double>& flux, double factor) {
    const auto n = Index(ends_.size());
    const Eigen::Map<const Eigen::VectorXd> driven(flux.data(), n);
    std::vector<std::size_t> piece(ends_.size(), 0);
    std::size_t most = 100;
    Eigen::VectorXd flow(n);
    for (Index i = 0; i < n; ++i) {
      const LumpedEnd& end = ends_[std::size_t(i)];
      flow[i] = before_->flow[std::size_t(i)];
      if (!end.drop) continue;
      const std::vector<double>& q = end.drop->table()->at();
      piece[std::size_t(i)] = std::size_t(
          std::ranges::upper_bound(q, weight_[0] * flow[i] + past_flow(std::size_t(i))) - q.begin());
      most += 10 * q.size();
    }
    for (std::size_t k = 0; k < most; ++k) {
      const Eigen::VectorXd p = pressures(driven, factor, piece);
      const Eigen::VectorXd aim = driven - factor * (admittance_ * p);
      double part = 1;
      std::size_t leaves = ends_.size(), to = 0;
      for (std::size_t i = 0; i < ends_.size(); ++i) {
        if (!ends_[i].drop) continue;
        const std::vector<double>& at = ends_[i].drop->table()->at();
        const double rounding = point_rounding * std::max(std::abs(at.front()), std::abs(at.back()));
        const double past = past_flow(i), from = weight_[0] * flow[Index(i)] + past,
                     q = weight_[0] * aim[Index(i)] + past;
        const bool up = piece[i] < at.size() && q > at[piece[i]] + rounding,
                   down = piece[i] > 0 && q < at[piece[i] - 1] - rounding;
        if (!up && !down) continue;
        const double point = up ? at[piece[i]] : at[piece[i] - 1],
                     way = std::clamp((point - from) / (q - from), 0.0, 1.0);
        if (leaves < ends_.size() && way >= part) continue;
        part = way, leaves = i, to = up ? piece[i] + 1 : piece[i] - 1;
      }
      if (leaves == ends_.size()) {
        for (std::size_t i = 0; i < ends_.size(); ++i) {
          pressure_[i] = p[Index(i)];
          if (ends_[i].drop)
            (void)(*ends_[i].drop)(weight_[0] * aim[Index(i)] + past_flow(i));  // notes its use
        }
        return;
      }
      flow += part * (aim - flow);
      piece[leaves] = to;
    }
    throw SolveFailure("The pressure drops behind the outlets were not found at t = {:.6g} s.", step_.end());
  }
  /// (r + (dt/rho) k S) p = s + k F for the present pieces of all tables.
  Eigen::VectorXd pressures(const Eigen::VectorXd& driven, double factor,
                            const std::vector<std::size_t>& piece) {
    const auto n = Index(ends_.size());
    Eigen::MatrixXd matrix(n, n);
    Eigen::VectorXd side(n);
    for (Index i = 0; i < n; ++i) {
      const auto e = std::size_t(i);
      if (ends_[e].volume == 0) {
        // Divided by 1 + Z, for resistances up to infinity.
        const CircuitLaw law = law_of_circuit(e, piece[e]);
        const double scale = 1 / (1 + law.impedance), z = law.impedance * scale;
        laws_[e] = {scale, weight_[0] * z, z * past_flow(e) + scale * law.known};
      }
      const EndLaw& law = laws_[e];
      matrix.row(i) = law.k * factor * admittance_.row(i);
      matrix(i, i) += law.r;
      side[i] = law.s + law.k * driven[i];
      if (law.r == 0 && admittance_(i, i) <= least_answer * faces_[e]) {
        matrix.row(i).setZero();
        matrix(i, i) = 1;
        side[i] = pressure_[e];
      }
      side[i] /= matrix(i, i);
      matrix.row(i) /= matrix(i, i);
    }
    return n == 1 ? side : Eigen::VectorXd(matrix.partialPivLu().solve(side));
  }

  const std::vector<LumpedEnd>& ends_;
  bool trapezoidal_;
  bool alone_ = false;  // no other condition gives the level of the pressure
  std::vector<double> pressure_;
  std::vector<EndLaw> laws_;
  /// Weights of the values at t^{n+1}, t^n, t^{n-1}: of flows, and of pressures of compliances, which do not jump at the start of a flow.
  std::array<double, 3> weight_{}, stored_weight_{};
  const CircuitsState* before_ = nullptr;                 // of level n
  std::vector<std::vector<double>> response_, accepted_;  // Y per end and local cell
  std::vector<double> faces_;                             // |G_i| [m]
  Eigen::MatrixXd admittance_;                            // S [m]
};

}  // namespace

template <int D>
void add_end_terms(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
                   Terms<D>& terms) {
  add_term<LumpedEnds<D>>(!scene.boundary.ends().empty(), scene, step, prediction, terms);
}

template decltype(add_end_terms<2>) add_end_terms<2>;
template decltype(add_end_terms<3>) add_end_terms<3>;

}  // namespace couplet::fluid
