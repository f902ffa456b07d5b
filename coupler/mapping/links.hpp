// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Maps values between two sets of points by a sparse matrix over the coupler's ranks, built once on the
/// reference configuration. Types of `coupling.mapping`:
///   matched     matching vertices and faces, weight 1
///   nearest     as below
///   projection  at vertices: the value at the nearest point of the other surface; at faces, and where corners are
///               not listed: local interpolants by compact radial functions
/// The latter carries linear fields exactly. Amounts go by the transpose of such a map the other way, so that
/// their sum and their moment are kept: those at faces by that of means over faces, those at vertices by that of
/// points. Motion and load of one wall go by ConjugateMap. A map of amounts is refused unless all that a place gives
/// is taken. All calls are collective.
class Mapping {
 public:
  enum class Kind {
    consistent,    ///< nearest: each target takes the value of its nearest source (displacements, velocities)
    conservative,  ///< nearest: every source is shared out, by size, among the targets nearest to it (or goes
                   ///< to its own nearest target if it is nearest to none): forces; the sum is kept
  };
  /// matched: throws Error with points that have no match, place and distance. nearest: accepts any distance.
  Mapping(MPI_Comm comm, Kind kind, const PointSet& from, const PointSet& to,
          const MappingParameters& parameters);

  /// Uses entries made elsewhere, except those between other locations.
  Mapping(MPI_Comm comm, const PointSet& from, const PointSet& to, Kind kind,
          std::vector<Transfer::Entry> entries);

  /// Mapping on one rank.
  Mapping(Kind kind, const PointSet& from, const PointSet& to, const MappingParameters& parameters)
      : Mapping(MPI_COMM_SELF, kind, whole_set(from), whole_set(to), parameters) {}

  /// Maps values at this rank's part of the sources to its part of the targets.
  std::vector<double> apply(const std::vector<double>& values, int components) const {
    return transfer_.apply(values, components);
  }
  std::size_t n_from() const { return n_from_; }  ///< on all ranks
  std::size_t n_to() const { return n_to_; }
  double max_distance() const { return max_distance_; }
  double mean_distance() const { return mean_distance_; }
  /// For example "168 vertices of 'solid' to 168 vertices of 'fluid', distance at most 0 m, mean 0 m".
  std::string summary() const { return summary_; }

 private:
  void set(MPI_Comm comm, Kind kind, const PointSet& from, const PointSet& to,
           std::vector<Transfer::Entry> entries, const std::vector<Neighbour>& forth,
           const std::vector<Neighbour>& back);

  std::size_t n_from_ = 0, n_to_ = 0;
  Transfer transfer_;
  double max_distance_ = 0, mean_distance_ = 0;
  std::string summary_;
};

/// Connections between any number of participants. A datum comes from another participant that gives one of
/// the same name. If several give it (two structures in one fluid), each place takes the nearest; if several
/// take an amount (N, W), each place gives it to the nearest. Their surfaces must not touch. Amounts keep
/// their sum; other data are mapped consistently. A datum named "own-..." is taken from the participant
/// itself: its value from the last pass, accelerated with the rest of the unknown.
class Links {
 public:
  /// Throws Error if a datum has no giver or several in the same place, or if units or numbers of components
  /// differ. Collective.
  Links(MPI_Comm comm, const std::vector<Side>& sides, const MappingParameters& mapping);

  struct Link {
    std::size_t giver, taker;
    coupling::Interface::Datum datum;  ///< as given
    int components;
    coupling::Interface::Place to;           ///< place where it is taken
    std::shared_ptr<const Mapping> mapping;  ///< shared by all data between the same places
    bool whole = true;    ///< between all places of both; false if some have other partners
    bool within = false;  ///< its values within the step are mapped, too: requested, and from one giver
  };
  const std::vector<Link>& all() const { return links_; }

  /// Input of participant `taker` from all data `given` so far; missing ones are omitted. Values within the
  /// step go to those that requested them. Collective.
  coupling::Exchange input(std::size_t taker, const std::vector<coupling::Exchange>& given) const;

  /// Transferred amount: sums over the places of giver and taker.
  struct Amount {
    std::string column;  ///< for example "tank gives force x [N]"
    double value = 0;
  };
  std::vector<Amount> amounts(const std::vector<coupling::Exchange>& given) const;

  /// One sentence per link, and one for data without a receiver.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::vector<double> carried(const Link& link, const std::string& name,
                              const std::vector<double>& values) const;
  MPI_Comm comm_;
  std::vector<std::string> names_;
  // Numbers of this rank's vertices and faces, per participant.
  std::vector<std::vector<std::size_t>> entries_;
  std::vector<Link> links_;
  std::vector<std::string> notes_;
};

}  // namespace couplet::coupler
