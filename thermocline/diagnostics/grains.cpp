// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Checks grains with a single shell. It assumes a parabolic profile (linear driving force), delayed by
/// d^2/(60 a) for slow changes and inaccurate for fast ones: 1/h becomes (1 + Bi/5)/h. Behind a front the
/// fluid was within 0.1 % of 20 shells at Bi 10, within 1.2 % at Bi 100 (docs/stability.md).
class ResolvedGrains final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void look(diagnostics::Report& report) override {
    if (bed().shells() > 1 || !(seen_->flow > 0)) return;
    const double biot = largest_biot();
    constexpr double limit = 20;
    tell(report, {.effect = "resolved grains",
                  .number = biot,
                  .limit = limit,
                  .what = fmt::format(
                      "Biot number of the grains = {:.2g}: their inside has {:.2g} of the film resistance",
                      biot, biot / 5),
                  .advice = "set 'bed.shells': five resolve the grains",
                  .share = 1.2e-4 * biot});
    report.position.push_back({"Biot number of the grains", biot, limit, "tank-biot"});
  }
  void conclude(diagnostics::Report& report) override {
    double largest = 0;
    for (const auto& run : bed().grid().runs)
      if (run.layer.porosity < 1) largest = std::max(largest, run.layer.diameter);
    const Filler& filler = view_.model.setup().filler;
    if (bed().shells() == 1 && largest > 0)
      report.sentences.push_back(fmt::format(
          "grains: with shells: 1 each grain has one temperature and a parabolic profile (linear driving "
          "force); grains of {:.3g} mm follow changes slower than {:.3g} s; five shells are accurate to 2 % for "
          "all changes",
          1e3 * largest, largest * largest * filler.volumetric() / (60 * filler.conductivity)));
    if (!(seen_->flow > 0)) return;
    std::string layers;
    for (std::size_t r = 0; r < bed().grid().runs.size(); ++r) {
      const BedGrid::Run& run = bed().grid().runs[r];
      layers += fmt::format(
          "{}{:.3g}", layers.empty() ? "" : ", ",
          bed().closure(r).reynolds(bed().fluid()[run.first + run.count / 2], seen_->flow / bed().area()));
    }
    report.sentences.push_back(
        fmt::format("closures: Re of the layers at the largest flow {} from the bottom up; the film "
                    "correlation is fitted to Re from 15 to 8500",
                    layers));
  }

 private:
  /// Film times d/(2 conductivity) of grain layers at the largest flow and the bed's mean temperature.
  double largest_biot() const {
    double mean = 0, largest = 0;
    for (const double t : bed().fluid()) mean += t / double(bed().fluid().size());
    for (std::size_t r = 0; r < bed().grid().runs.size(); ++r) {
      const BedLayer& layer = bed().grid().runs[r].layer;
      if (layer.porosity >= 1 || layer.melting) continue;
      const Filler& filler = layer.filler ? *layer.filler : view_.model.setup().filler;
      const double film = bed().closure(r).at(mean, MassFlux(seen_->flow / bed().area())).film;
      largest = std::max(largest, film * layer.diameter / (2 * filler.conductivity));
    }
    return largest;
  }
};

}  // namespace

Made grains(const TankView& view, const Seen& seen) { return std::make_shared<ResolvedGrains>(view, seen); }

}  // namespace couplet::thermocline
