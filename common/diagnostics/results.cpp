// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
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

constexpr std::size_t tables_of_choice = 2;  // probes and coefficients

// Share of the largest value of a unit below which a value is round-off.
constexpr double round_off = 1e-9;

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
      rows.push_back({.name = tables[table.rank].second + name,
                      .unit = unit,
                      .values = {table.last[i]},
                      .rank = table.rank < tables_of_choice ? 0 : 1});
  }
}

/// Factor and prefix with which the largest of some values has one to three digits before the point.
std::pair<double, std::string> prefix_of(const std::string& unit, double largest) {
  constexpr std::array scaled{"Pa", "N", "J", "W", "Hz", "m", "m/s", "N m"};
  constexpr std::array prefixes{"n", "u", "m", "", "k", "M", "G", "T"};
  if (std::ranges::count(scaled, unit) == 0 || !(largest > 0) || !std::isfinite(largest)) return {1, unit};
  const int most = unit[0] == 'm' ? 0 : 4;  // kilometers are no usual unit of a result
  const int power = std::clamp(int(std::floor(std::log10(largest) / 3 + 1e-9)), -3, most);
  return {std::pow(1000.0, -power), prefixes.at(std::size_t(power + 3)) + unit};
}

double largest_of(const std::vector<double>& values, double level = 0) {
  double largest = 0;
  for (const double v : values)
    if (std::isfinite(v)) largest = std::max(largest, std::abs(v - level));
  return largest;
}

std::string share_of_value(double error) {
  return error < 1 ? fmt::format("{:.2g} %", 100 * error) : "useless";
}

/// Values below `nothing` are 0.
std::string text(const Result& r, double nothing) {
  const double largest = largest_of(r.values);
  const auto [factor, unit] = prefix_of(r.unit, largest > nothing ? largest : 0);
  std::string line;
  for (std::size_t i = 0; i < r.values.size(); ++i) {
    const double v = r.values[i];
    line += fmt::format("{}{:.5g}", line.empty() ? "" : "  ",
                        std::abs(v) > nothing || std::isnan(v) ? v * factor : 0);
    if (i < r.errors.size()) line += fmt::format(" (+- {})", share_of_value(r.errors[i]));
  }
  if (unit != "1" && unit != "-" && !unit.empty()) line += " " + unit;
  if (!r.errors.empty()) return line;
  if (std::isfinite(r.error)) {
    const std::string share = share_of_value(r.error);
    line += r.unit == "Hz" || largest <= nothing
                ? " +- " + share
                : fmt::format(" +- {:.2g} ({})", r.error * largest * factor, share);
  } else if (r.rank < 2) {
    line += " +- unknown";
  }
  return line + (r.place.empty() ? "" : " " + r.place);
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

void set_errors(const std::string& name, std::vector<double> errors) {
  const auto found = std::ranges::find(set_rows(), name, &Result::name);
  if (found == set_rows().end() || errors.empty()) return;
  found->error = std::ranges::max(errors);
  errors.resize(std::min(errors.size(), found->values.size()));
  found->errors = std::move(errors);
}

const char* hint_on_unit(double largest, double mesh_scale) {
  constexpr double usual = 10;  // [m]; what is drawn in millimeters is rarely smaller
  return mesh_scale == 1 && largest >= usual ? "(if in mm: 'mesh-scale: 0.001')" : "";
}

void set_mesh_size(const Vec3& size, int dimension, double mesh_scale) {
  set_result({.name = "size of the mesh",
              .unit = "m",
              .values = {size.data(), size.data() + dimension},
              .error = std::numeric_limits<double>::infinity(),
              .place = hint_on_unit(size.maxCoeff(), mesh_scale),
              .rank = 2});
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
  if (rank == 0)
    set_result({.name = name, .unit = unit, .values = {most.value}, .place = place_text(at), .rank = 2});
}

std::vector<double>* results_of_table(const std::string& file, const std::vector<std::string>& columns) {
  const auto* found = std::ranges::find(tables, std::string_view(file), &decltype(tables)::value_type::first);
  if (found == tables.end()) return nullptr;
  return &known_tables().emplace_back(std::size_t(found - tables.begin()), columns).last;
}

std::vector<Result> results(const ErrorParts& errors) {
  std::vector<Result> rows = set_rows();
  for (std::size_t rank = 0; rank < tables.size(); ++rank)
    for (const ResultTable& table : known_tables())
      if (table.rank == rank) add(table, rows);
  // Such as the outlet temperature of a tank at rest.
  std::erase_if(rows, [](const Result& r) {
    return std::ranges::none_of(r.values, [](double v) { return std::isfinite(v); });
  });
  std::ranges::stable_sort(rows, {}, &Result::rank);
  std::map<std::string, double> largest;  // of each unit
  for (const Result& r : rows) largest[r.unit] = std::max(largest[r.unit], largest_of(r.values));
  const double error = known_error(errors);
  for (Result& r : rows) {
    const double mine = largest_of(r.values), nothing = round_off * largest[r.unit];
    if (std::isnan(r.error) && r.unit == errors.unit && mine > nothing)
      r.error = error * std::max(largest_of(r.values, errors.level), errors.size) / mine;
    r.text = text(r, nothing);
  }
  return rows;
}

std::string results_text(const std::string& participant, double time, std::size_t most,
                         const ErrorParts& errors, const std::vector<std::string>& verdict) {
  const std::vector<Result> rows = results(errors);
  std::string block = fmt::format("Results of '{}' at t = {:g} s", participant, time);
  std::size_t width = 0;
  for (std::size_t i = 0; i < std::min(most, rows.size()); ++i)
    width = std::max(width, std::min<std::size_t>(rows[i].name.size(), 34));
  for (std::size_t i = 0; i < std::min(most, rows.size()); ++i)
    block += fmt::format("\n  {:<{}}  {}", rows[i].name, width, rows[i].text);
  if (rows.size() > most) block += fmt::format("\n  and {} more: couplet report", rows.size() - most);
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
  const auto wrong = std::ranges::find_if(findings(), [](const Finding& f) {
    return f.severity == base::Severity::wrong && f.id != "error-estimate" && !is_accepted(f.id);
  });
  if (std::string next = wrong != findings().end() ? wrong->advice : best_change(participants);
      !next.empty()) {
    if (next.size() > 70) next.resize(std::min(next.size(), next.rfind(", for")));
    if (next.size() <= 70) lines.push_back("  next: " + next);
  }
  return lines;
}

}  // namespace couplet::diagnostics
