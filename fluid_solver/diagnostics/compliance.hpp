// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

namespace couplet::fluid {

/// How walls move and how the pressure answers, over the time of a run: fluctuations about the means. Sums over the faces of
/// other ranks are the caller's.
class ComplianceWatch {
 public:
  /// Of all ranks.
  struct Totals {
    double swept = 0;            ///< net volume that the walls have swept [m^3]
    double pressure_volume = 0;  ///< pressure times the volume that it compresses [J]
  };
  /// After a step of length dt [s]. `swept`: volume swept since the start by each face of the moving walls [m^3].
  void add(double dt, const std::vector<double>& swept, const Totals& totals);

  /// Of this rank's faces, sum over them: mean square of the volume that they sweep, of its rate, and the root mean square of
  /// the volume; [m^6], [m^6/s^2], [m^3].
  struct Walls {
    double square = 0, rate = 0, size = 0;
  };
  Walls walls() const;
  /// Root mean squares about the means.
  Totals totals() const;

  /// For checkpoints: the values per face, and what is the same on all ranks.
  std::array<std::vector<double>*, 4> per_face() { return {&last_, &sum_, &square_, &rate_}; }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(time_, mean_.swept, mean_.pressure_volume, mean_square_.swept, mean_square_.pressure_volume,
            steps_);
  }

 private:
  std::vector<double> last_, sum_, square_, rate_;  // per face
  double time_ = 0;
  Totals mean_, mean_square_;  // times time_
  int steps_ = 0;
};

}  // namespace couplet::fluid
