// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/diagnostics/error_parts.hpp"
#include "common/diagnostics/finding.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::diagnostics {

/// Where a run stands on a map of the atlas (docs/stability.md), in the terms of its axis.
struct Coordinate {
  std::string quantity;  ///< "Courant number"
  double value = 0;
  double limit = 0;    ///< up to here the map is green
  std::string map{};   ///< "fluid-convection"
  bool floor = false;  ///< true: from here up
  /// Share of the way to the limit [1], above 1 beyond it. With a floor the way begins at 1, the best value.
  double used() const { return floor ? (1 - value) / (1 - limit) : value / limit; }
  /// For checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(quantity, value, limit, map, floor);
  }
};

/// Keeps of each quantity the coordinate that is nearer to its limit.
void keep_nearest(std::vector<Coordinate>& kept, const std::vector<Coordinate>& seen);
/// "on the map: Courant number 0.8 of 1, ...; nearest limit: ..."; empty without coordinates.
std::string position_sentence(const std::vector<Coordinate>& position);

/// Collects what diagnostics say.
struct Report {
  /// Findings of an effect or of the answer. A note is a sound one: it is told at the end of the run only.
  std::vector<Finding> findings;
  std::vector<std::string> sentences;  ///< for the end of the log
  ErrorParts errors;                   ///< parts of the estimated error, each over the size of the solution
  std::vector<Coordinate> position;
};

/// Looks at a run from outside and judges its answer. It reads what the program shows of itself (its view) and changes
/// nothing there. Each one keeps a reference to its view, which outlives it. All calls are collective over the ranks of
/// the program.
class Diagnostic {
 public:
  virtual ~Diagnostic() = default;
  /// After each accepted step.
  virtual void observe(Report&) {}
  /// After steps 1, 2, 4, 8, ... and each hundredth, at outputs and at the end: says what the accepted state shows. Of what
  /// it says over the run the worst counts.
  virtual void look(Report&) {}
  /// At the end of a run that was not given up, after the last look().
  virtual void conclude(Report&) {}
  /// Saves or loads its memory of the run. A resumed run must end with the findings of the unbroken one.
  virtual void visit(io::Archive&) {}
};

/// A new diagnostic; nullptr where it does not apply to a run.
using Made = std::shared_ptr<Diagnostic>;

/// All diagnostics of one program in a run: calls them, tells their findings, and keeps the worst of each. What they
/// have found is part of the checkpoint. All calls are collective.
class Diagnostics {
 public:
  /// `with_errors`: the parts of the error are wanted.
  Diagnostics(int rank, bool with_errors) : rank_(rank), with_errors_(with_errors) {}
  bool with_errors() const { return with_errors_; }
  /// `name`: of its memory in checkpoints, different for each. nullptr: it does not apply to this run.
  void add(std::string name, std::shared_ptr<Diagnostic> diagnostic) {
    if (diagnostic) all_.push_back({std::move(name), std::move(diagnostic)});
  }

  /// After an accepted step that ended at `time` [s].
  void accepted(double time);
  /// Now, because output is due.
  void look();
  /// After the last step, once. `failed`: the run was given up, so that its error and what it neglected are not judged
  /// except for what has been found already. Gives the lines for the end of the log.
  std::vector<std::string> conclude(bool failed);

  /// The worst of each finding so far, notes included.
  const std::vector<Finding>& findings() const { return worst_; }
  /// Parts of the error, the model's included, once the run is concluded.
  const ErrorParts& errors() const { return errors_; }
  /// Where the run came nearest to the limits of its maps.
  const std::vector<Coordinate>& position() const { return position_; }

  /// Saves or loads what was found and the memory of each diagnostic. `Archive` is io::Archive, which this folder, below
  /// io, only knows by name.
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
  bool with_errors_;
  std::vector<Named> all_;
  long steps_ = 0;
  double time_ = 0;
  std::vector<Finding> worst_;        // of each id and subject
  std::vector<Coordinate> position_;  // nearest to its limit, of each quantity
  ErrorParts errors_;
  bool concluding_ = false;
};

/// A finding about an effect that a scene leaves out, or that it has. Nothing if `number` is not known.
struct EffectFinding {
  const char* effect = "";  ///< its name; the id of the finding is the name in lower case with hyphens
  double number = 0;        ///< size of what is left out; NaN: not known
  double limit = 0;         ///< neglecting it is justified up to here
  std::string what;         ///< the number in words, with its unit: "max |grad u| = 0.29"
  std::string advice{};
  bool left_out = true;  ///< false: the scene has it
  /// The answer is useless from here on.
  double wrong_from = std::numeric_limits<double>::infinity();
  double share = std::numeric_limits<double>::quiet_NaN();  ///< see Finding
  double saves = 0;                                         ///< see Finding
};
std::optional<Finding> finding_of(const EffectFinding& effect);

/// Adds the model's part of the error: the sum of the shares that are known, and what could be omitted.
void add_model(const std::vector<Finding>& findings, ErrorParts& errors);

}  // namespace couplet::diagnostics
