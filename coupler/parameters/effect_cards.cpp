// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {
namespace {

using P = CouplingParameters;
using AccelerationType = AccelerationParameters::Type;
using MappingType = MappingParameters::Type;

std::string when(bool on, const char* reason) { return on ? reason : ""; }
const char* semi_implicit_of(const P& p) {
  return p.scheme.adapts ? "scheme: auto" : "scheme: semi-implicit";
}
bool iterates(const P& p) { return p.scheme != coupling::Scheme::explicit_; }
/// True if participants see a guessed motion before the structure gives its own.
bool predicts(const P& p) { return predictor_order_of(p) > 0; }

const std::array cards{
    CouplingCard{"exchange among any participants", "`exchange`",
                 [](const P& p) { return when(p.exchange.has_value(), "exchange"); },
                 "sums of the exchanged amounts"},
    CouplingCard{"iteration of the whole step", "`scheme: implicit`, or `auto` where friction requires it",
                 [](const P& p) {
                   return when(
                       p.scheme.adapts || p.scheme == coupling::Scheme::implicit,
                       p.scheme.adapts ? "scheme: auto, where friction requires it" : "scheme: implicit");
                 },
                 "all participants and the mesh motion once per pass"},
    CouplingCard{
        "iteration of pressure and structure", "`scheme: auto` or `semi-implicit`",
        [](const P& p) { return when(p.scheme.is_semi_implicit(), semi_implicit_of(p)); },
        "a pressure solve and a structure step per pass; mesh motion and predictor once per step",
        "explicit: share of a change of the motion that the next pass returns, 0.5 (predictor of order 2: "
        "0.17); two additional passes in the second step and in steps 4, 16, 64, ..."},
    CouplingCard{"friction of the current wall velocity",
                 "`scheme: auto` or `semi-implicit`, implicit viscous term",
                 [](const P& p) { return when(p.scheme.is_semi_implicit(), semi_implicit_of(p)); },
                 "two vectors per interface face, a loop over it per pass"},
    CouplingCard{
        "prediction renewed",
        "`scheme: auto` or `semi-implicit`, where the friction error exceeds 0.1 % of the load (heavy structures: 5 "
        "%), up to four times per step",
        [](const P& p) { return when(p.scheme.is_semi_implicit(), semi_implicit_of(p)); },
        "sums over the interface per pass; where active, the first part of the fluid's step is repeated "
        "each time"},
    CouplingCard{"viscous coupling load",
                 "by a structure that takes `viscous-force` in addition to `pressure-force`",
                 [](const P& p) {
                   return when(p.fluid.has_value() || p.exchange.has_value(), "what the structure takes");
                 },
                 "a force per interface face", "fluid forces not taken over those taken, 0.02", true},
    CouplingCard{"relaxation by Aitken", "`acceleration.type: aitken`",
                 [](const P& p) {
                   return when(iterates(p) && p.acceleration.type == AccelerationType::aitken,
                               "acceleration.type: aitken");
                 },
                 "two vectors of the interface"},
    CouplingCard{"quasi-Newton of the interface", "`acceleration.type: iqn-ils`",
                 [](const P& p) {
                   return when(iterates(p) && p.acceleration.type == AccelerationType::iqn_ils,
                               "acceleration.type");
                 },
                 "three interface vectors for each of at most `maximum-columns` differences"},
    CouplingCard{"prediction", "`predictor.order` above 0",
                 [](const P& p) { return when(predicts(p), "predictor.order"); },
                 "the motion of two earlier steps"},
    CouplingCard{"mapping between non-matching surfaces", "`mapping.type` other than `matched`",
                 [](const P& p) { return when(p.mapping.type != MappingType::matched, "mapping.type"); },
                 "a sparse matrix over the interface, computed once"},
    CouplingCard{"mesh motion", "`mesh`", [](const P& p) { return when(p.mesh.has_value(), "mesh"); },
                 "the process mesh_mover"},
    CouplingCard{"mesh on the guess", "`mesh-on-guess`, implicit scheme",
                 [](const P& p) { return when(p.mesh_on_guess, "mesh-on-guess"); },
                 "the motion of the guess, kept for the step"},
    CouplingCard{"load as the unknown", "`order: structure-first`",
                 [](const P& p) {
                   return when(p.order == P::Exchange::Order::structure_first, "order: structure-first");
                 },
                 "face forces in addition to the vertex motion in the unknown"},
    CouplingCard{"sub-steps", "`sub-steps`",
                 [](const P& p) { return when(!p.sub_steps.empty(), "sub-steps"); },
                 "state n of the sub-stepping participant, in memory; that many of its steps per pass"},
    CouplingCard{"interface data for ParaView", "`interface-output: true`",
                 [](const P& p) { return when(p.interface_output, "interface-output"); },
                 "a file for each interface and output"},
    CouplingCard{"integrals over interfaces", "`watch`",
                 [](const P& p) { return when(!p.watch.empty(), "watch"); },
                 "corner coordinates of each watched interface, a loop over its faces per step"},
    CouplingCard{
        "guards that stop", "`on-divergence: stop`",
        [](const P& p) { return when(p.on_divergence == P::OnDivergence::stop, "on-divergence: stop"); },
        "a few sums over the interface per step",
        "motion caused by the coupling itself: growing oscillations, diverging work, diverging iterations"},
};

}  // namespace

std::span<const CouplingCard> coupling_effect_cards() { return cards; }

}  // namespace couplet::coupler
