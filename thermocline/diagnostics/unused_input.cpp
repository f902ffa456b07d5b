// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "common/io/checkpoint.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Reports input without effect: schedule rows that never ran, capsules that neither melted nor froze, days
/// that the report could not use.
class UnusedInput final : public TankDiagnostic {
 public:
  explicit UnusedInput(const RunOfTank& run)
      : TankDiagnostic(run), flowed_(run.view.parameters().flow.rows.size(), 0) {}
  void observe(diagnostics::Report&) override {
    for (const BedStep& s : view_.happened.bed) {
      reached_ = s.t;
      if (has_schedule() && s.flow.mode > 0) flowed_[std::size_t(s.flow.mode - 1)] = 1;
    }
  }
  void conclude(diagnostics::Report& report) override {
    if (has_schedule()) check_rows(report);
    check_plant(report);
    check_capsules(report);
    if (!view_.report) return;
    const std::vector<std::string> doubts = view_.report->doubts();
    for (std::size_t i = 0; i < doubts.size(); ++i) add(report, "day-report", std::to_string(i), doubts[i]);
  }
  void visit(io::Archive& archive) override {
    archive.common("rows", reached_, flowed_);
    flowed_.resize(view_.parameters().flow.rows.size());  // a run may go on with other rows
  }

 private:
  bool has_schedule() const { return view_.parameters().flow.type == FlowParameters::Type::schedule; }

  void check_rows(diagnostics::Report& report) const {
    const std::vector<ScheduleRow>& rows = view_.parameters().flow.rows;
    const auto began = [&](const ScheduleRow& row) { return row.at <= reached_ + 1e-6; };
    const auto first = std::ranges::find_if(rows, [](const ScheduleRow& r) { return r.mass_flow != 0; });
    if (first != rows.end() && !began(*first))
      add(report, "given-without-effect", "first",
          fmt::format("no flow: the first row with a flow, flow.rows[{}], starts at {:g} s",
                      first - rows.begin(), first->at));
    else if (const auto later = std::ranges::find_if_not(rows, began); later != rows.end()) {
      add(report, "given-without-effect", "later",
          fmt::format("flow.rows[{}] starts at {:g} s, after the end of the run; of {} rows {} ran",
                      later - rows.begin(), later->at, rows.size(), later - rows.begin()));
      // A short run of a long schedule is no fault, but one that only sees its first row may have other units.
      if (later - rows.begin() > 1) report.findings.back().severity = base::Severity::note;
    }
    check_end(report);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const ScheduleRow& row = rows[i];
      if (row.mass_flow == 0 || !began(row) || flowed_[i] != 0) continue;
      std::string limits;
      if (row.stop_above) limits += fmt::format(" above {:g} degC", celsius(*row.stop_above));
      if (row.stop_below)
        limits += fmt::format("{} below {:g} degC", limits.empty() ? "" : " and", celsius(*row.stop_below));
      add(report, "given-without-effect", std::to_string(i),
          fmt::format(
              "flow.rows[{}] never ran: it stops{}, and the outlet (the {} of the tank) was beyond that whenever it started. "
              "Are the sign of the flow (upward, out of the top, is above 0) and the bed's initial-temperature correct?",
              i, limits, row.mass_flow > 0 ? "top" : "bottom"));
    }
  }

  /// Reports a plant that neither charged nor discharged the tank.
  void check_plant(diagnostics::Report& report) const {
    const FlowParameters& flow = view_.parameters().flow;
    if (flow.type != FlowParameters::Type::plant || seen_->flow > 0) return;
    const PlantParameters& p = flow.plant;
    add(report, "given-without-effect", "plant",
        fmt::format(
            "the plant moved no heat: up to {:g} h the sun brought {:.3g} kWh/m^2. The bottom of the bed is at {:.1f} degC "
            "(charging starts at {:.1f} degC or below, with more sun than the block uses), its top at {:.1f} degC (discharging "
            "starts at {:.1f} degC or above). Check 'ambient', the hours of the run and 'bed.initial-temperature'",
            view_.time() / seconds_an_hour, view_.weather.irradiation(0, view_.time()) / 3.6e6,
            celsius(bed().bottom()), celsius(p.cold + p.restart), celsius(bed().top()),
            celsius(p.hot - p.restart)));
  }

  /// Reports a last row with a flow that holds far longer than the whole schedule before it.
  void check_end(diagnostics::Report& report) const {
    const FlowParameters& flow = view_.parameters().flow;
    if (flow.repeat || flow.rows.size() < 2 || flow.rows.back().mass_flow == 0) return;
    constexpr double long_times = 10;
    const double span = flow.rows.back().at - flow.rows.front().at, held = reached_ - flow.rows.back().at;
    if (held > long_times * span)
      add(report, "given-without-effect", "end",
          fmt::format(
              "the last row, flow.rows[{}], starts at {:g} s, and its flow continued for {:g} s, {:.0f} times the duration of "
              "all rows before it: add a final row without flow, or check the unit of the times",
              flow.rows.size() - 1, flow.rows.back().at, held, held / span));
  }

  void check_capsules(diagnostics::Report& report) const {
    const std::vector<BedLayer>& layers = view_.parameters().bed.layers;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      if (!layers[i].melting) continue;
      const Melting& m = *layers[i].melting;
      const double low = m.temperature - m.width / 2, high = m.temperature + m.width / 2;
      if (seen_->hottest <= low || seen_->coldest >= high)
        add(report, "given-without-effect", fmt::format("layer {}", i),
            fmt::format("bed.layers[{}]: its capsules melt from {:.1f} to {:.1f} degC, but the fluid stayed "
                        "between {:.1f} and {:.1f} degC: their latent heat had no effect",
                        i, celsius(low), celsius(high), celsius(seen_->coldest), celsius(seen_->hottest)));
    }
  }

  double reached_ = -1;       // start of the last step of the bed [s]
  std::vector<char> flowed_;  // rows of the schedule
};

}  // namespace

diagnostics::Made unused_input(const RunOfTank& run) { return std::make_shared<UnusedInput>(run); }

}  // namespace couplet::thermocline
