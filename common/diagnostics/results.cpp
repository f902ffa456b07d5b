// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <string_view>
#include <utility>

#include "common/diagnostics/finding.hpp"

namespace couplet::diagnostics {
namespace {

/// Tables with results and the beginning of their names, most important first.
constexpr std::array<std::pair<std::string_view, const char*>, 12> tables{{{"probes", ""},
                                                                           {"coefficients", ""},
                                                                           {"reactions", "reaction "},
                                                                           {"forces", "force "},
                                                                           {"bodies", ""},
                                                                           {"flow-areas", "flow area "},
                                                                           {"heat", "heat "},
                                                                           {"contact", "contact "},
                                                                           {"gaps", "gap "},
                                                                           {"amounts", ""},
                                                                           {"energies", "energy "},
                                                                           {"tank", ""}}};

struct ResultTable {
  std::size_t rank;
  std::vector<std::string> columns;
  std::vector<double> last;
};

std::vector<Result>& set_rows() {
  static std::vector<Result> rows;
  return rows;
}

std::deque<ResultTable>& known_tables() {
  static std::deque<ResultTable> all;
  return all;
}

/// Adds the columns of a table. "tip x [m]" and "tip y [m]" are one row "tip".
void add(const ResultTable& table, std::vector<Result>& rows) {
  std::string before;
  for (std::size_t i = 1; i < table.last.size(); ++i) {
    const std::string& column = table.columns[i];
    const std::size_t bracket = column.rfind(" [");
    std::string name = column.substr(0, bracket);
    const std::string unit =
        bracket == column.npos ? "" : column.substr(bracket + 2, column.size() - bracket - 3);
    const bool is_component =
        name.size() > 2 && name[name.size() - 2] == ' ' && name.back() >= 'x' && name.back() <= 'z';
    const bool continues = is_component && name.back() > 'x' && name.substr(0, name.size() - 2) == before;
    if (is_component) name.resize(name.size() - 2);
    before = is_component ? name : "";
    if (continues)
      rows.back().values.push_back(table.last[i]);
    else
      rows.push_back({tables[table.rank].second + name, unit, {table.last[i]}});
  }
}

std::string text(const Result& r, std::size_t width) {
  std::string values;
  for (const double value : r.values) values += fmt::format("{}{:.5g}", values.empty() ? "" : "  ", value);
  std::string line = fmt::format("  {:<{}}  {}", r.name, width, values);
  if (r.unit != "1" && r.unit != "-" && !r.unit.empty()) line += " " + r.unit;
  std::string more;
  if (std::isfinite(r.error))
    more += r.values.size() == 1
                ? fmt::format(" +- {:.2g} ({:.2g} %)", r.error * std::abs(r.values[0]), 100 * r.error)
                : fmt::format(" +- {:.2g} %", 100 * r.error);
  if (!r.place.empty()) more += " " + r.place;
  const bool fits = line.size() + more.size() < 80;
  return line + (fits || more.empty() ? more : "\n     " + more);
}

}  // namespace

std::string place_text(const Vec3& place) {
  return fmt::format("at ({:.4g}, {:.4g}, {:.4g}) m", place.x(), place.y(), place.z());
}

void set_result(Result result) {
  const auto found = std::ranges::find(set_rows(), result.name, &Result::name);
  if (found == set_rows().end())
    set_rows().push_back(std::move(result));
  else
    *found = std::move(result);
}

void set_largest(MPI_Comm comm, const char* name, const char* unit, double value, const Vec3& place) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  struct {
    double value;
    int rank;
  } most{value, rank};
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  Vec3 at = place;
  MPI_Bcast(at.data(), 3, MPI_DOUBLE, most.rank, comm);
  if (rank == 0) set_result({.name = name, .unit = unit, .values = {most.value}, .place = place_text(at)});
}

std::vector<double>* results_of_table(const std::string& file, const std::vector<std::string>& columns) {
  const auto* found = std::ranges::find(tables, std::string_view(file), &decltype(tables)::value_type::first);
  if (found == tables.end()) return nullptr;
  return &known_tables().emplace_back(std::size_t(found - tables.begin()), columns).last;
}

std::vector<Result> results() {
  std::vector<Result> rows = set_rows();
  for (std::size_t rank = 0; rank < tables.size(); ++rank)
    for (const ResultTable& table : known_tables())
      if (table.rank == rank) add(table, rows);
  // Such as the outlet temperature of a tank at rest.
  std::erase_if(rows, [](const Result& r) {
    return std::ranges::none_of(r.values, [](double v) { return std::isfinite(v); });
  });
  return rows;
}

std::string results_text(const std::string& participant, double time, std::size_t most,
                         const std::vector<std::string>& verdict) {
  const std::vector<Result> rows = results();
  std::string block = fmt::format("Results of '{}' at t = {:g} s", participant, time);
  std::size_t width = 0;
  for (std::size_t i = 0; i < std::min(most, rows.size()); ++i)
    width = std::max(width, std::min<std::size_t>(rows[i].name.size(), 34));
  for (std::size_t i = 0; i < std::min(most, rows.size()); ++i) block += "\n" + text(rows[i], width);
  if (rows.size() > most)
    block += fmt::format("\n  and {} more in its tables and run.json", rows.size() - most);
  for (const std::string& line : verdict) block += "\n" + line;
  return block;
}

std::vector<std::string> verdict(const std::vector<NamedErrors>& participants) {
  std::vector<std::string> ids;
  bool is_wrong = false;
  for (const Finding& f : findings()) {
    if (f.severity == base::Severity::note || is_accepted(f.id)) continue;
    is_wrong |= f.severity == base::Severity::wrong;
    if (std::ranges::count(ids, f.id) == 0) ids.push_back(f.id);
  }
  std::vector<std::string> lines{
      fmt::format("Verdict: {}; {}",
                  is_wrong      ? "useless"
                  : ids.empty() ? "no warning"
                                : fmt::format("{} warning{}", ids.size(), ids.size() == 1 ? "" : "s"),
                  error_summary(participants))};
  if (!ids.empty()) {
    std::string list = "  " + ids.front();
    std::size_t n = 1;
    for (; n < ids.size() && list.size() + ids[n].size() < 48; ++n) list += ", " + ids[n];
    if (n < ids.size()) list += fmt::format(" and {} more", ids.size() - n);
    lines.push_back(list + " (docs/findings.md)");
  }
  if (std::string next = best_change(participants); !next.empty()) {
    if (next.size() > 70) next.resize(std::min(next.size(), next.rfind(", for")));
    if (next.size() <= 70) lines.push_back("  next: " + next);
  }
  return lines;
}

}  // namespace couplet::diagnostics
