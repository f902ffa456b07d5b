// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/error_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "common/base/error.hpp"

namespace couplet {
namespace {

// Of the largest part: less buys nothing.
constexpr double nothing = 0.1;

struct Kind {
  const char* name;
  double ErrorParts::*value;
  const char* words;
  const char* advice;  // where it dominates
};

constexpr std::array<Kind, 4> kinds{
    {{"mesh", &ErrorParts::mesh, "mesh", "a finer mesh would reduce it"},
     {"step", &ErrorParts::step, "step", "a shorter time step would reduce it"},
     {"linear", &ErrorParts::linear, "linear tolerance", "a tighter solver tolerance would reduce it"},
     {"coupling", &ErrorParts::coupling, "coupling tolerance",
      "a tighter 'convergence' of the coupling would reduce it"}}};

struct Part {
  const Kind* kind;
  double value;
  std::string whose;
};

/// What would buy nothing, as words: "halving the step", ...
std::string idle_words(const std::vector<Part>& parts, double most) {
  std::string words;
  for (const Part& p : parts) {
    if (!(p.value < nothing * most)) continue;
    const std::string_view name = p.kind->name;
    words += words.empty() ? "" : " or ";
    words += name == "step"   ? "halving the step"
             : name == "mesh" ? "refining the mesh"
                              : fmt::format("tightening the {}", p.kind->words);
  }
  return words;
}

/// Of each kind the participant's that has most.
std::vector<Part> largest_parts(const std::vector<NamedErrors>& participants) {
  std::vector<Part> parts;
  for (const Kind& k : kinds) {
    const NamedErrors* largest = nullptr;
    for (const NamedErrors& n : participants)
      if (!std::isnan(n.parts.*k.value) && (!largest || n.parts.*k.value > largest->parts.*k.value))
        largest = &n;
    if (largest) parts.push_back({&k, largest->parts.*k.value, largest->name});
  }
  return parts;
}

}  // namespace

bool ErrorParts::known() const {
  return std::ranges::any_of(kinds, [this](const Kind& k) { return !std::isnan(this->*k.value); });
}

std::string ErrorParts::text() const {
  std::string text;
  for (const Kind& k : kinds)
    if (!std::isnan(this->*k.value))
      text += fmt::format("{}{} {:.6g}", text.empty() ? "" : " ", k.name, this->*k.value);
  return text;
}

ErrorParts ErrorParts::of(const std::string& text) {
  ErrorParts parts;
  std::istringstream words(text);
  for (std::string name; words >> name;) {
    const auto kind = std::ranges::find_if(kinds, [&](const Kind& k) { return k.name == name; });
    double value = 0;
    if (kind == kinds.end() || !(words >> value))
      throw Error(
          "'{}' is not a valid list of error parts: expected names (mesh, step, linear, coupling), each "
          "with a number.",
          text);
    parts.*(kind->value) = value;
  }
  return parts;
}

double total_error(const std::vector<NamedErrors>& participants) {
  double total = 0;
  for (const Part& p : largest_parts(participants)) total += p.value;
  return total;
}

std::optional<log::Finding> worthless(const std::vector<NamedErrors>& participants) {
  const double total = total_error(participants);
  if (!(total >= as_large_as_the_solution)) return {};
  double largest = 0;
  for (const Part& p : largest_parts(participants)) largest = std::max(largest, p.value);
  return log::Finding{
      .id = "error-estimate",
      .severity = largest >= as_large_as_the_solution ? Severity::wrong : Severity::warning,
      .number = total,
      .limit = as_large_as_the_solution,
      .sentence = fmt::format("estimated error: {:.2g} of the solution (limit {:g}): result not reliable",
                              total, as_large_as_the_solution),
      .advice = "refine the dominant part"};
}

std::vector<std::string> error_sentences(const std::vector<NamedErrors>& participants) {
  std::vector<Part> parts = largest_parts(participants);
  if (parts.empty()) return {};
  std::ranges::stable_sort(parts, std::greater<>{}, &Part::value);
  std::string list;
  const bool several = participants.size() > 1;
  for (const Part& p : parts) {
    list += fmt::format("{}{} {:.2g}{}", list.empty() ? "" : ", ", p.kind->words, p.value,
                        several ? " (" + p.whose + ")" : "");
  }
  const Part& worst = parts.front();
  // The largest part of many a run: a number without it must not pass for the whole.
  const bool knows_mesh =
      std::ranges::any_of(parts, [](const Part& p) { return p.kind->value == &ErrorParts::mesh; });
  std::vector<std::string> sentences{
      fmt::format("estimated error {:.2g} of the solution: {}{}.", total_error(participants), list,
                  knows_mesh ? ""
                             : "; the error due to the mesh (or truncated modes) is unknown and not "
                               "included")};
  if (parts.size() < 2 || !(worst.value > 0)) return sentences;
  const std::string idle = idle_words(parts, worst.value);
  sentences.push_back(fmt::format("the {}{} dominates: {}{}.", worst.kind->words,
                                  several ? " (" + worst.whose + ")" : "", worst.kind->advice,
                                  idle.empty() ? "" : "; " + idle + " would not help"));
  return sentences;
}

}  // namespace couplet
