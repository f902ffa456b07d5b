// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/error_parts.hpp"
#include "coupler/acceleration/unknown.hpp"

namespace couplet::coupler {

/// What explicit coupling leaves in the motion: the load of a step answers a predicted velocity w, the structure then moves
/// with v. Of d = v - w comes back through the load in the same step, per step,
///   c d,  c = added + direct,
/// where `added` does not depend on dt (an added mass: its force is that of (d^n - d^{n-1}) / dt, so that errors of single
/// steps cancel in their sum) and `direct` grows with it (a damping: direct / dt is a rate, errors add up). Two looks at
/// steps of dt and dt / 2 tell the two apart.
///
/// Of a structure that swings, the part of that force that does work changes the amplitude by A, relative, the part in
/// phase with the acceleration changes its phase by P [rad]. Both are taken from D = int d dt, u and v, and of these from what is left of
/// their mean over time, so that modes count by the displacement that they hold and no step's ringing hides the motion; a
/// mode's share is the same in d, v and dv/dt. With cov(x, y) = int (x - mean x).(y - mean y) dt over the time T since the start
/// and the whole interface,
///   A = T / (2 cov(u, u)) (direct/dt cov(D, u) - added cov(D, v)),
///   P = w T / 2 (added cov(D, u) / cov(u, u) + direct/dt cov(D, v) / cov(v, v)),  w^2 = cov(v, v) / cov(u, u)
/// over 1 + c; the displacement's error is hypot(A, P), at most 2, times V / w, V the largest |v| of late. Masses on springs in a
/// fluid that answers by added mass and drag follow this within a factor of two. A flow whose load remembers differently (boundary
/// layers, sudden starts) leaves more: at most, where no step's error cancels another's, c sum |d| of the velocity, over w (or
/// times T, if that is less) of the displacement. These two are the range that is told.
class LagEstimate {
 public:
  /// An unknown that is no motion alone cannot be judged.
  LagEstimate(MPI_Comm comm, const Unknown& unknown);
  /// Whether it can say anything; nothing is to be looked at else.
  bool possible() const { return possible_; }

  /// A pass from x gave `image`, one from there `again`, in steps of dt and of half as much; nothing is learnt from noise.
  struct Look {
    Iterate x, image, again;
  };
  void looked(const Look& whole, const Look& half, double dt);
  /// A step was accepted, its pass from x to `image`. Collective.
  void accepted(const Iterate& x, const Iterate& image, double dt);
  /// Of the displacement over its largest size [1].
  struct Range {
    double least = std::numeric_limits<double>::quiet_NaN(), most = least;
  };
  /// NaN before the first look.
  Range over_size() const;
  /// The range in words, and whether iterating would buy anything beside what the participants know of their own errors.
  std::string sentence(const std::vector<coupling::NamedErrors>& participants) const;
  static std::string not_possible();
  /// For checkpoints.
  std::vector<double> state() const;
  void restore(std::span<const double> state);
  /// Of this rank's part of the interface: D, and D, u and v integrated over time.
  std::array<std::vector<double>*, 4> fields() { return {&lag_, &lags_, &ways_, &speeds_}; }

 private:
  /// -(again - image).(image - x) / |image - x|^2 of the velocities; NaN: noise. Collective.
  double returned(const Look& look) const;

  /// Over time, dt times products of vectors and their sums over the interface.
  struct Sums {
    double Du = 0, Dv = 0, uu = 0, vv = 0, time = 0;
    double late = 0, size = 0;  // largest |v| of late [m/s], largest displacement [m]
    double added = 0, rate = 0,
           answer = 0;            // rate: direct / dt [1/s], of the last look; answer: the largest |c| of all
    double looks = 0, jumps = 0;  // jumps: sum of |d|
  };
  static constexpr std::size_t values = 12;
  static std::array<double*, values> list(Sums& s);
  /// cov(x, y) from the integrals of x.y, x and y. Collective.
  double covariance(double xy, const std::vector<double>& x, const std::vector<double>& y) const;

  MPI_Comm comm_;
  bool possible_ = false;
  std::vector<double> lag_, lags_, ways_,
      speeds_;  // D now [m], and D, u, v integrated over time, this rank's
  Sums sums_;
};

}  // namespace couplet::coupler
