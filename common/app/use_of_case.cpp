// SPDX-License-Identifier: Apache-2.0
#include "common/app/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/fv/use.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::app {
namespace {

using fv::Use;

constexpr double least_unseen = 0.5;           // of the largest value that the steps see
constexpr double coldest_of_expression = 200;  // [K]; one in degC, which takes no unit, would be below
constexpr double margin = 0.01;                // of the range of a table of a material, beyond its ends

class UseOfCase final : public diagnostics::Diagnostic {
 public:
  explicit UseOfCase(MPI_Comm comm) : comm_(comm) {}
  void look(diagnostics::Report& report) override {
    for (const auto& [name, use] : together()) {
      if (use.kind != Use::Kind::effect || !use.key.plausible || !use.is_used()) continue;
      auto [least, most] = *use.key.plausible;
      if (use.key.unit == "K") least = std::max(least, coldest_of_expression);
      const bool is_cold = use.key.unit == "K" && use.lowest < least;
      if (is_cold || use.largest() > most)
        report.findings.push_back(
            {.id = "questionable-key",
             .sentence = fmt::format(
                 "{}: {} yields {:.6g} {} (usual: {:g} to {:g} {}): implausible; an expression yields {}",
                 name, use.given, is_cold ? use.lowest : use.largest(), use.key.unit, least, most,
                 use.key.unit, use.key.unit),
             .subject = name});
    }
  }
  void conclude(diagnostics::Report& report) override {
    const std::map<std::string, Use> all = together();
    const auto energy = all.find("energy");
    const bool is_at_rest = energy != all.end() && energy->second.largest() == 0;
    const bool acts = std::ranges::any_of(all, [](const auto& entry) {
      return entry.second.kind == Use::Kind::effect && entry.second.is_used() && entry.second.largest() > 0;
    });
    for (const auto& [name, use] : all) {
      if (use.is_used() && !(acts && use.kind == Use::Kind::energy)) report_use(report, name, use);
      // A part that never acted is then the reason.
      if (is_at_rest && use.kind == Use::Kind::effect && !report.findings.empty() &&
          report.findings.back().id == "given-without-effect")
        report.findings.back().severity = base::Severity::wrong;
    }
  }
  void visit(io::Archive& archive) override {
    std::map<std::string, Use> all = together();
    archive.common("uses", all);
    if (archive.reads())
      for (auto& [name, before] : all) {
        const auto [now, is_new] =
            fv::uses().try_emplace(name, before);                   // new: only the start of a run reads it
        if (is_new || now->second.given != before.given) continue;  // other given since
        before.key = now->second.key, before.from = now->second.from, before.to = now->second.to;
        now->second = before;
      }
  }

 private:
  struct UseRange {
    double lowest, highest, unseen, unseen_at, last_time;
    Vec3 place;
  };
  /// Uses over all ranks.
  std::map<std::string, Use> together() const {
    std::map<std::string, Use> all = fv::uses();
    std::vector<UseRange> mine;
    for (const auto& [name, use] : all)
      mine.push_back({use.lowest, use.highest, use.unseen, use.unseen_at, use.last_time, use.place});
    const std::vector<UseRange> seen = parallel::all_gather(comm_, mine);
    for (std::size_t i = 0; i < seen.size(); i += mine.size()) {
      std::size_t j = i;
      for (auto& [name, use] : all) {
        const UseRange& there = seen[j++];
        if (std::max(-there.lowest, there.highest) > use.largest()) use.place = there.place;
        if (there.unseen > use.unseen) use.unseen = there.unseen, use.unseen_at = there.unseen_at;
        use.lowest = std::min(use.lowest, there.lowest);
        use.highest = std::max(use.highest, there.highest);
        use.last_time = std::fmax(use.last_time, there.last_time);
      }
    }
    return all;
  }

  static void report_use(diagnostics::Report& report, const std::string& name, const Use& use) {
    const auto find = [&](const char* id, double number, double limit, std::string sentence) {
      report.findings.push_back(
          {.id = id, .number = number, .limit = limit, .sentence = std::move(sentence), .subject = name});
    };
    const bool is_left = use.lowest < use.from - margin * (use.to - use.from) ||
                         use.highest > use.to + margin * (use.to - use.from);
    switch (use.kind) {
      case Use::Kind::energy:
        if (use.largest() == 0)
          find("given-without-effect", 0, 0,
               "the run is at rest: nothing in the case loads or moves anything");
        break;
      case Use::Kind::effect:
        if (use.largest() == 0)
          find("given-without-effect", 0, 0,
               fmt::format(
                   "{}: {} never acted, anywhere or at any time: check its position, its times and its units",
                   name, use.given));
        else if (use.unseen > least_unseen * use.largest() &&
                 !name.starts_with("motion."))  // also used at trial times
          find(
              "unseen-between-steps", use.unseen / use.largest(), least_unseen,
              fmt::format(
                  "{}: {} differs by {:.3g} from its values at the neighboring steps around t = {:g} s (largest value at all steps: {:.3g}): the steps miss this change; shorten 'time-step'",
                  name, use.given, use.unseen, use.unseen_at, use.largest()));
        break;
      case Use::Kind::table:
        if (use.highest < use.from || use.lowest > use.to)
          find(
              "given-without-effect", 0, 0,
              fmt::format(
                  "{}: it covers {:g} to {:g}, but was only read from {:g} to {:g}, where its end value is used",
                  name, use.from, use.to, use.lowest, use.highest));
        else if (is_left)
          report.sentences.push_back(fmt::format(
              "{}: it covers {:g} to {:g} and was read from {:g} to {:g}; beyond its ends its end values were used.",
              name, use.from, use.to, use.lowest, use.highest));
        break;
      case Use::Kind::property:
        if (is_left)
          find(
              "table-left", use.highest, use.to,
              fmt::format(
                  "{}: its table covers {:.6g} to {:.6g} K, but was read from {:.6g} to {:.6g} K; beyond its ends the end values are used: extend it",
                  name, use.from, use.to, use.lowest, use.highest));
    }
  }

  MPI_Comm comm_;
};

}  // namespace

diagnostics::Made use_of_case(MPI_Comm comm) { return std::make_shared<UseOfCase>(comm); }

}  // namespace couplet::app
