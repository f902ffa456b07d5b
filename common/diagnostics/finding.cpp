// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/finding.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/text.hpp"
#include "common/log/log.hpp"

namespace couplet::diagnostics {
namespace {

std::vector<Finding>& kept() {
  static std::vector<Finding> all;
  return all;
}

std::vector<std::string>& accepted_ids() {
  static std::vector<std::string> ids;
  return ids;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + '"';
}

std::string number_text(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null"; }

std::string line(const Finding& f) {
  return fmt::format("{}{}{} [{}{}]", f.severity == base::Severity::wrong ? "WRONG: " : "", f.sentence,
                     f.advice.empty() ? "" : "; " + f.advice, f.id, is_accepted(f.id) ? ", accepted" : "");
}

}  // namespace

void finding(int rank, Finding f) {
  finding_id(f.id);
  if (rank == 0) {
    if (f.severity == base::Severity::note)
      log::info("{}", line(f));
    else
      log::warn("{}", line(f));
  }
  kept().push_back(std::move(f));
}

void amend(const Finding& worse) {
  const auto same = [&](const Finding& f) { return f.id == worse.id && f.subject == worse.subject; };
  std::ranges::replace_if(kept(), same, worse);
}

const std::vector<Finding>& findings() { return kept(); }

void resume_findings(int rank, const std::vector<Finding>& earlier) {
  std::vector<Finding> again = std::move(kept());
  kept() = earlier;
  for (const Finding& f : earlier)
    if (rank == 0) log::info("found before the restart: {}", line(f));
  for (Finding& f : again)
    if (std::ranges::none_of(earlier,
                             [&](const Finding& e) { return e.id == f.id && e.sentence == f.sentence; }))
      kept().push_back(std::move(f));
}

void accept(std::span<const std::string> ids) { accepted_ids().assign(ids.begin(), ids.end()); }

double& share_limit() {
  static double limit = 0.05;
  return limit;
}

bool is_accepted(const std::string& id) { return std::ranges::count(accepted_ids(), id) > 0; }

int count(base::Severity least, bool with_neglected) {
  return int(std::ranges::count_if(kept(), [&](const Finding& f) {
    const bool counts = with_neglected || finding_id(f.id).about == FindingId::About::answer;
    return f.severity >= least && counts && !is_accepted(f.id);
  }));
}

int doubts() { return count(base::Severity::warning, true); }

std::string findings_as_json() {
  std::string out;
  for (const Finding& f : kept())
    out += fmt::format(
        "{}\n    {{\"id\": {}, \"severity\": \"{}\", \"number\": {}, \"limit\": {}, \"sentence\": {}, \"advice\": {}, "
        "\"neglected-effect\": {}, \"share\": {}, \"accepted\": {}}}",
        out.empty() ? "" : ",", quoted(f.id), base::name(f.severity), number_text(f.number),
        number_text(f.limit), quoted(f.sentence), quoted(f.advice),
        finding_id(f.id).about == FindingId::About::neglected, number_text(f.share), is_accepted(f.id));
  return "[" + out + (out.empty() ? "]" : "\n  ]");
}

}  // namespace couplet::diagnostics
