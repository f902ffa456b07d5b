// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/diagnostics/error_parts.hpp"
#include "common/diagnostics/finding.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::diagnostics {

/// Position of a run on one axis of a map in the atlas (docs/stability.md).
struct Coordinate {
  std::string quantity;  ///< "Courant number"
  double value = 0;
  double limit = 0;    ///< the map is green up to this value
  std::string map{};   ///< "fluid-convection"
  bool floor = false;  ///< true if the map is green from `limit` upwards
  /// Fraction of the limit that is used [1], above 1 beyond it. For a floor it is measured from 1, the best
  /// value.
  double used() const { return floor ? (1 - value) / (1 - limit) : value / limit; }
  /// Archives the members in checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(quantity, value, limit, map, floor);
  }
};

/// Keeps, for each quantity, the coordinate that is closer to its limit.
void keep_nearest(std::vector<Coordinate>& kept, const std::vector<Coordinate>& seen);
/// Text "stability: Courant number 0.8 (limit 1), ...: within the tested range (...)". Empty without coordinates.
std::string position_sentence(const std::vector<Coordinate>& position);

/// Results of diagnostics.
struct Report {
  /// Findings about an effect or the result. A note confirms that it is sound and is printed only at the end.
  std::vector<Finding> findings;
  std::vector<std::string> sentences;  ///< for the end of the log
  ErrorParts errors;                   ///< parts of the estimated error, relative to the size of the solution
  std::vector<Coordinate> position;
};

/// Judges the result of a run from the outside. It reads the program's view without changing anything. It
/// keeps a reference to the view, which outlives it. All calls are collective over the ranks of the program.
class Diagnostic {
 public:
  virtual ~Diagnostic() = default;
  /// Called after each accepted step.
  virtual void observe(Report&) {}
  /// Called after steps 1, 2, 4, 8, ..., after each hundredth, at outputs and at the end. Reports on the
  /// accepted state; the worst finding of the run counts.
  virtual void look(Report&) {}
  /// Called at the end of a completed run, after the last look().
  virtual void conclude(Report&) {}
  /// Saves or loads its memory of the run. A resumed run must end with the findings of an uninterrupted one.
  virtual void visit(io::Archive&) {}
};

/// New diagnostic, or nullptr if it does not apply to a run.
using Made = std::shared_ptr<Diagnostic>;

/// Runs in which a diagnostic takes part (`simulation.diagnostics`): all, those that estimate errors, or those that ask for all.
enum class When { always, with_errors, in_full };

/// Row of a program's table of diagnostics. `Of` is what the program shows of itself.
template <class Of, class Which = Made>
struct TableRow {
  const char* name;  ///< unique; identifies the memory in checkpoints
  When when;
  Which (*make)(const Of&);  ///< nullptr if it does not apply to the case
};

/// All diagnostics of one program in a run. Calls them, logs their findings and keeps the worst of each. The
/// findings are part of the checkpoint. All calls are collective.
class Diagnostics {
 public:
  /// `most`: diagnostics that take part at most.
  Diagnostics(int rank, When most) : rank_(rank), most_(most) {}
  bool is_full() const { return most_ == When::in_full; }
  /// Adds a diagnostic. `name` must be unique; it identifies the memory in checkpoints. nullptr is ignored.
  void add(std::string name, std::shared_ptr<Diagnostic> diagnostic) {
    if (diagnostic) all_.push_back({std::move(name), std::move(diagnostic)});
  }
  /// Adds the diagnostics of a table that take part in this run, and returns them.
  template <class Of, class Which>
  std::vector<Which> add(std::span<const TableRow<Of, Which>> table, const Of& view) {
    std::vector<Which> added;
    for (const TableRow<Of, Which>& row : table) {
      if (row.when > most_) continue;
      if (Which made = row.make(view)) {
        add(row.name, made);
        added.push_back(std::move(made));
      }
    }
    return added;
  }

  /// Called after an accepted step that ended at `time` [s].
  void accepted(double time);
  /// Looks at the accepted state because output is due.
  void look();
  /// Concludes after the last step and returns the lines for the end of the log. If the run `failed`, its
  /// error and neglected effects are not judged beyond existing findings.
  std::vector<std::string> conclude(bool failed);

  /// Worst of each finding so far, notes included.
  const std::vector<Finding>& findings() const { return worst_; }
  /// Parts of the error, including the model's, after conclude().
  const ErrorParts& errors() const { return errors_; }
  /// Coordinates at which the run came closest to the limits of its maps.
  const std::vector<Coordinate>& position() const { return position_; }

  /// Saves or loads the findings and the memory of each diagnostic. `Archive` is io::Archive, which is only
  /// declared in this folder because io depends on it.
  template <class Archive>
  void visit(Archive& archive) {
    std::vector<Finding> found = diagnostics::findings();
    std::vector<std::string> names;
    for (const Named& one : all_) names.push_back(one.name);
    archive.common("findings", found, worst_, position_, steps_, time_, names);
    if (archive.reads()) resume_findings(rank_, found);
    for (const Named& one : all_) {
      if (std::ranges::count(names, one.name) == 0) continue;  // new in this run
      archive.set_prefix("diagnostic-" + one.name + "-");
      one.diagnostic->visit(archive);
    }
    archive.set_prefix("");
  }

 private:
  struct Named {
    std::string name;
    std::shared_ptr<Diagnostic> diagnostic;
  };
  void take(Report& report);

  int rank_;
  When most_;
  std::vector<Named> all_;
  long steps_ = 0, looked_at_ = 0;
  double time_ = 0;
  std::vector<Finding> worst_;        // of each id and subject
  std::vector<Coordinate> position_;  // of each quantity, closest to its limit
  ErrorParts errors_;
  bool concluding_ = false;
};

/// Limit of a number that rests on a value that the case does not give: it is stated for information, without a verdict.
constexpr double no_verdict = std::numeric_limits<double>::infinity();

/// Finding about an effect that a scene neglects or includes. Not reported if `number` is unknown.
struct EffectFinding {
  const char* effect = "";  ///< its name
  const char* id = "";      ///< of the finding; empty if it is the name in lower case with hyphens
  double number = 0;        ///< its size; NaN if unknown
  double limit = 0;         ///< of the number, up to which an effect is adequate, or no_verdict
  std::string what;         ///< the number in words, with its unit: "max |grad u| = 0.29"
  std::string advice{};
  bool left_out = true;  ///< false if the scene includes it
  /// Value from which the result is useless.
  double wrong_from = std::numeric_limits<double>::infinity();
  /// Share of the result that a neglected effect changes [1]. It alone decides the verdict, with share_limit(). NaN if unknown:
  /// then the verdict is "unknown", with a warning above the limit of the number.
  double share = std::numeric_limits<double>::quiet_NaN();
  /// True if the scene includes the effect, and up to the limit could leave it out.
  bool is_spare = false;
  double saves = 0;  ///< see Finding
};
std::optional<Finding> finding_of(const EffectFinding& effect);

/// Adds the model's part of the error: the sum of the known shares of findings that the case does not accept, and effects that could be omitted.
void add_model(const std::vector<Finding>& findings, ErrorParts& errors);

}  // namespace couplet::diagnostics
