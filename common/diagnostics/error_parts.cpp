// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/error_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/diagnostics/results.hpp"

namespace couplet::diagnostics {
namespace {

// Contributions below this fraction of the largest one are not worth reducing.
constexpr double nothing = 0.1;
// Below this, the known part of an error is not stated beside an unknown one.
constexpr double least_said = 1e-4;
// Error from which the result is questionable. Estimates are accurate to a factor, and this one may represent
// a fifth, beyond which the atlas calls a result wrong.
constexpr double questionable_error = 0.15;

struct ErrorKind {
  const char* name;
  double ErrorParts::*value;
  const char* words;
};

constexpr std::array<ErrorKind, 5> kinds{{{"mesh", &ErrorParts::mesh, "mesh"},
                                          {"step", &ErrorParts::step, "step"},
                                          {"linear", &ErrorParts::linear, "linear tolerance"},
                                          {"coupling", &ErrorParts::coupling, "coupling tolerance"},
                                          {"model", &ErrorParts::model, "model"}}};

struct ErrorPart {
  const ErrorKind* kind;
  double value;
  const NamedErrors* of;
  bool is(double ErrorParts::*which) const { return kind->value == which; }
};

/// Cheapest change that lowers a contribution, and its price. What half the cell size or step leaves follows from the
/// order of convergence, which one run does not know.
std::string cure(const ErrorPart& part) {
  if (part.is(&ErrorParts::mesh)) {
    constexpr std::array cells{"4 to 8 times", "twice", "4 times", "8 times"};
    return fmt::format("half the cell size (with {} the cells)",
                       cells.at(std::size_t(std::clamp(part.of->parts.dimension, 0, 3))));
  }
  if (part.is(&ErrorParts::step)) return "half the time step (with twice the steps)";
  if (part.is(&ErrorParts::linear)) return "a tenth of the solver tolerance (with a few more iterations)";
  if (part.is(&ErrorParts::coupling))
    return "a tenth of 'convergence' of the coupling (with one or two more iterations per step)";
  return part.of->parts.model_by;
}

/// Largest contribution of each kind over the participants.
std::vector<ErrorPart> largest_parts(const std::vector<NamedErrors>& participants) {
  std::vector<ErrorPart> parts;
  for (const ErrorKind& k : kinds) {
    const NamedErrors* largest = nullptr;
    for (const NamedErrors& n : participants)
      if (!std::isnan(n.parts.*k.value) && (!largest || n.parts.*k.value > largest->parts.*k.value))
        largest = &n;
    if (largest) parts.push_back({&k, largest->parts.*k.value, largest});
  }
  return parts;
}

bool misses_mesh(const NamedErrors& n) {
  return std::isnan(n.parts.mesh) && !(std::isnan(n.parts.step) && std::isnan(n.parts.linear));
}

bool misses_step(const std::vector<NamedErrors>& participants) { return largest(participants).misses_step; }

/// "the mesh", with the names of the participants that know other parts of their error but not that one, and
/// "the step". Empty if there are none.
std::string unknown_part(const std::vector<NamedErrors>& participants) {
  std::vector<std::string> names;
  for (const NamedErrors& n : participants)
    if (misses_mesh(n)) names.push_back(n.name);
  const bool is_step = misses_step(participants);
  if (names.empty()) return is_step ? "the step" : "";
  const std::string mesh =
      participants.size() > 1 ? fmt::format("the mesh of '{}'", base::join(names, "', '")) : "the mesh";
  return is_step ? mesh + " and the step" : mesh;
}

}  // namespace

bool ErrorParts::known() const {
  return std::ranges::any_of(kinds, [this](const ErrorKind& k) { return !std::isnan(this->*k.value); });
}

std::string ErrorParts::text() const {
  std::string text;
  for (const ErrorKind& k : kinds)
    if (!std::isnan(this->*k.value))
      text += fmt::format("{}{} {:.6g}", text.empty() ? "" : " ", k.name, this->*k.value);
  if (!text.empty() && dimension > 0) text += fmt::format(" dimension {}", dimension);
  if (!text.empty() && misses_step) text += " misses-step 1";
  if (!field.empty() || !model_by.empty() || !omittable.empty())
    text += fmt::format(" | {} | {} | {}", field, model_by, omittable);
  return text;
}

ErrorParts ErrorParts::of(const std::string& text) {
  ErrorParts parts;
  const std::size_t words_at = text.find(" | ");
  if (words_at != text.npos) {
    const std::size_t second = text.find(" | ", words_at + 3), last = text.rfind(" | ");
    parts.field = text.substr(words_at + 3, second - words_at - 3);
    if (last > second) parts.model_by = text.substr(second + 3, last - second - 3);
    if (second != text.npos) parts.omittable = text.substr(last + 3);
  }
  std::istringstream words(text.substr(0, words_at));
  for (std::string name; words >> name;) {
    const auto kind = std::ranges::find_if(kinds, [&](const ErrorKind& k) { return k.name == name; });
    double value = 0;
    const bool is_about = name == "dimension" || name == "misses-step";
    if ((kind == kinds.end() && !is_about) || !(words >> value))
      throw Error(
          "'{}' is not a valid list of error parts: expected names (mesh, step, linear, coupling, model), "
          "each with a number.",
          text);
    if (name == "dimension")
      parts.dimension = int(std::clamp(value, 0.0, 3.0));
    else if (name == "misses-step")
      parts.misses_step = value != 0;
    else
      parts.*(kind->value) = value;
  }
  return parts;
}

ErrorParts largest(const std::vector<NamedErrors>& participants) {
  ErrorParts parts;
  for (const ErrorPart& p : largest_parts(participants)) {
    parts.*(p.kind->value) = p.value;
    if (p.is(&ErrorParts::model)) parts.model_by = p.of->parts.model_by;
    if (p.is(&ErrorParts::mesh)) parts.dimension = p.of->parts.dimension;
  }
  for (const NamedErrors& n : participants)
    parts.misses_step |= std::isnan(parts.step) && n.parts.misses_step;
  for (const NamedErrors& n : participants)
    if (!n.parts.omittable.empty())
      parts.omittable +=
          fmt::format("{}{}: {}", parts.omittable.empty() ? "" : "; ", n.name, n.parts.omittable);
  return parts;
}

double total_error(const std::vector<NamedErrors>& participants) {
  double total = 0;
  for (const ErrorPart& p : largest_parts(participants))
    if (!p.is(&ErrorParts::model)) total += p.value;
  return total;
}

namespace {

std::string percent(double share) {
  return share >= as_large_as_the_solution ? "above 100 %" : fmt::format("{:.2g} %", 100 * share);
}

/// Largest known contribution that is not of the model and not 0.
std::optional<ErrorPart> worst_part(const std::vector<NamedErrors>& participants) {
  std::optional<ErrorPart> worst;
  for (const ErrorPart& p : largest_parts(participants))
    if (!p.is(&ErrorParts::model) && p.value > (worst ? worst->value : 0)) worst = p;
  return worst;
}

}  // namespace

double known_error(const ErrorParts& parts) {
  const std::vector<NamedErrors> alone{{"", parts}};
  return parts.known() && unknown_part(alone).empty() ? total_error(alone) : ErrorParts::unknown;
}

std::string error_summary(const std::vector<NamedErrors>& participants) {
  std::string list;
  double most = 0;
  for (const NamedErrors& n : participants) most = std::max(most, total_error({n}));
  for (const NamedErrors& n : participants) {
    const std::string unknown = unknown_part({n});
    const double total = total_error({n});
    const auto worst = worst_part({n});
    if (unknown.empty() && (!worst || total < nothing * most)) continue;
    list += list.empty() ? "" : "; ";
    if (!n.parts.field.empty())
      list += n.parts.field + (participants.size() > 1 ? " of '" + n.name + "' " : " ");
    list += unknown.empty() ? fmt::format("{} ({})", percent(total), worst->kind->words)
            : total >= std::max(nothing * most, least_said)
                ? fmt::format("{} plus an unknown part ({})", percent(total), unknown)
                : fmt::format("unknown ({})", unknown);
  }
  return list.empty() ? "the error is not estimated" : "estimated error: " + list;
}

std::string best_change(const std::vector<NamedErrors>& participants) {
  const auto worst = worst_part(participants);
  if (misses_step(participants)) return "repeat the run with half the time step to see the error it causes";
  // Else the known part is large enough to begin with.
  if (std::ranges::any_of(participants, misses_mesh) && !(total_error(participants) >= questionable_error))
    return "repeat the run with half the cell size to see the error it causes";
  return worst ? cure(*worst) : "";
}

std::optional<Finding> worthless(const std::vector<NamedErrors>& participants) {
  const double total = total_error(participants);
  if (!(total >= questionable_error)) return {};
  const bool is_wrong = total >= as_large_as_the_solution;
  const double limit = is_wrong ? as_large_as_the_solution : questionable_error;
  return Finding{.id = "error-estimate",
                 .severity = is_wrong ? base::Severity::wrong : base::Severity::warning,
                 .number = total,
                 .limit = limit,
                 .sentence = fmt::format("estimated error: {:.2g} of the solution (limit {:g}): result {}",
                                         total, limit, is_wrong ? "not reliable" : "questionable"),
                 .advice = "refine the dominant part"};
}

std::vector<std::string> error_sentences(const std::vector<NamedErrors>& participants) {
  std::vector<ErrorPart> parts = largest_parts(participants);
  const bool several = participants.size() > 1;
  const std::string unknown = unknown_part(participants);
  std::vector<std::string> sentences;
  if (!parts.empty()) {
    std::ranges::stable_sort(parts, std::greater<>{}, &ErrorPart::value);
    std::string list;
    double total = 0;
    for (const ErrorPart& p : parts) {
      list += fmt::format("{}{} {:.2g}{}", list.empty() ? "" : ", ", p.kind->words, p.value,
                          several ? " (" + p.of->name + ")" : "");
      total += p.value;
    }
    sentences.push_back(
        unknown.empty()
            ? fmt::format("estimated error {:.2g} of the solution: {}.", total, list)
            : fmt::format(
                  "estimated error: the part due to {} is unknown; the rest is {:.2g} of the solution: {}.",
                  unknown, total, list));
  }
  for (const NamedErrors& n : participants)
    if (!n.parts.omittable.empty())
      sentences.push_back(
          fmt::format("could be omitted{}: {}.", several ? " of '" + n.name + "'" : "", n.parts.omittable));
  return sentences;
}

}  // namespace couplet::diagnostics
