// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/diagnostics/diagnostic.hpp"

namespace couplet::diagnostics {

/// All diagnostics of one program in a run: calls them, tells their findings, and keeps the worst of each. What they
/// have found is part of the checkpoint. All calls are collective.
class Diagnostics {
 public:
  /// `with_errors`: the parts of the error are wanted.
  Diagnostics(int rank, bool with_errors) : rank_(rank), with_errors_(with_errors) {}
  bool with_errors() const { return with_errors_; }
  /// `name`: of its memory in checkpoints, different for each.
  void add(std::string name, std::shared_ptr<Diagnostic> diagnostic) {
    all_.push_back({std::move(name), std::move(diagnostic)});
  }

  /// After an accepted step that ended at `time` [s].
  void accepted(double time);
  /// Now, because output is due.
  void look();
  /// After the last step, once. `failed`: the run was given up, so that its error and what it neglected are not judged
  /// except for what has been found already. Gives the lines for the end of the log.
  std::vector<std::string> conclude(bool failed);

  /// The worst of each finding so far, notes included.
  const std::vector<diagnostics::Finding>& findings() const { return worst_; }
  /// Parts of the error, the model's included, once the run is concluded.
  const diagnostics::ErrorParts& errors() const { return errors_; }
  /// Where the run came nearest to the limits of its maps.
  const std::vector<diagnostics::Coordinate>& position() const { return position_; }
  void visit(io::Archive& archive);

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
  std::vector<diagnostics::Finding> worst_;            // of each id and subject
  std::vector<diagnostics::Coordinate> position_;  // nearest to its limit, of each quantity
  diagnostics::ErrorParts errors_;
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
  double share = std::numeric_limits<double>::quiet_NaN();  ///< see diagnostics::Finding
  double saves = 0;                                         ///< see diagnostics::Finding
};
std::optional<diagnostics::Finding> finding_of(const EffectFinding& effect);

/// Adds the model's part of the error: the sum of the shares that are known, and what could be omitted.
void add_model(const std::vector<diagnostics::Finding>& findings, diagnostics::ErrorParts& errors);

}  // namespace couplet::diagnostics
