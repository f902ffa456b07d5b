// SPDX-License-Identifier: Apache-2.0
#include "common/app/run_report.hpp"

#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <utility>

#include "common/app/case/command_line.hpp"
#include "common/app/job.hpp"
#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/diagnostics/results.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::app {
namespace {

const char* const summary_file = "run.json";

/// Formats a JSON string.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", int(c));
    else
      out += c;
  }
  return out + '"';
}

std::string phases() {
  std::string out;
  for (const auto& [name, entry] : log::timers().entries())
    out += fmt::format("{}\n    {}: {:.6g}", out.empty() ? "" : ",", quoted(name), entry.seconds);
  return "{" + out + (out.empty() ? "}" : "\n  }");
}

std::string json(const diagnostics::ErrorParts& e) {
  const auto number = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null";
  };
  const auto words = [](const std::string& text) { return text.empty() ? "null" : quoted(text); };
  return fmt::format(
      "{{\"mesh\": {}, \"step\": {}, \"linear\": {}, \"coupling\": {}, \"model\": {}, \"model-by\": {}, \"could-be-omitted\": {}}}",
      number(e.mesh), number(e.step), number(e.linear), number(e.coupling), number(e.model),
      words(e.model_by), words(e.omittable));
}

std::string json(const std::vector<diagnostics::Coordinate>& position) {
  std::string out;
  for (const diagnostics::Coordinate& c : position)
    out += fmt::format(
        "{}\n    {{\"quantity\": {}, \"value\": {:.6g}, \"limit\": {:.6g}, \"floor\": {}, \"map\": {}}}",
        out.empty() ? "" : ",", quoted(c.quantity), c.value, c.limit, c.floor, quoted(c.map));
  return "[" + out + (out.empty() ? "]" : "\n  ]");
}

std::string json(const std::vector<diagnostics::Result>& results) {
  std::string out;
  for (const diagnostics::Result& r : results) {
    std::string values;
    for (const double v : r.values)
      values += fmt::format("{}{}", values.empty() ? "" : ", ",
                            std::isfinite(v) ? fmt::format("{:.9g}", v) : "null");
    std::string errors;
    for (const double e : r.errors) errors += fmt::format("{}{:.6g}", errors.empty() ? "" : ", ", e);
    out += fmt::format(
        "{}\n    {{\"name\": {}, \"values\": [{}], \"unit\": {}, \"error\": {}, \"errors\": [{}], \"place\": {}, \"rank\": {}, \"text\": {}}}",
        out.empty() ? "" : ",", quoted(r.name), values, quoted(r.unit),
        std::isfinite(r.error) ? fmt::format("{:.6g}", r.error) : "null", errors, quoted(r.place), r.rank,
        quoted(r.text));
  }
  return "[" + out + (out.empty() ? "]" : "\n  ]");
}

}  // namespace

double RunReport::processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// getrusage would include the memory of the parent process before exec.
double RunReport::peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024;
  return 0;
}

RunReport::RunReport(const Job& job, bool with_steps)
    : job_(job), time_(std::isnan(job.restart_time) ? 0 : job.restart_time) {
  if (job.rank != 0) return;
  base::when_started([file = job.output_folder / summary_file] {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
  });
  if (with_steps && job.simulation.output_steps)
    steps_.emplace(
        job.output_folder / "steps.csv",
        std::vector<std::string>{"time [s]", "dt [s]", "iterations", "error", "energy [J]", "seconds [s]"},
        job.restart_time);
}

void RunReport::accepted(double time, coupling::StepReport report) {
  report.seconds = std::exchange(since_accepted_, 0.0);
  time_ = time;
  ++count_;
  iterations_ += report.iterations;
  if (!steps_) return;
  steps_->row(
      std::array{time, report.dt, double(report.iterations), report.error, report.energy, report.seconds});
}

void RunReport::finish(double wall, const std::string& problem, const diagnostics::ErrorParts& errors,
                       const std::vector<diagnostics::Coordinate>& position) {
  const double cpu = parallel::sum(job_.comm, processor_seconds()),
               working = parallel::sum(job_.comm, working_);
  const double most = parallel::max(job_.comm, peak_memory()), all = parallel::sum(job_.comm, peak_memory());
  if (job_.rank != 0) return;
  const std::vector<diagnostics::NamedErrors> named{{job_.name, errors}};
  const std::string text = fmt::format(
      "{{\n  \"participant\": {},\n  \"version\": {},\n  \"ranks\": {},\n"
      "  \"state\": \"{}\",\n  \"reason\": {},\n  \"time\": {:.17g},\n  \"steps\": {},\n"
      "  \"iterations\": {},\n  \"wall\": {:.6g},\n  \"processor\": {:.6g},\n  \"processor-working\": "
      "{:.6g},\n  \"memory-most\": {:.6g},\n"
      "  \"memory-all\": {:.6g},\n  \"results\": {},\n  \"error\": {},\n  \"next\": {},\n  \"errors\": {},\n  \"atlas\": {},\n  \"findings\": {},\n  \"phases\": {}\n}}\n",
      quoted(job_.name), quoted(version_text()), parallel::comm_size(job_.comm),
      problem.empty() ? "ended" : "failed", quoted(problem), time_, count_, iterations_, wall, cpu, working,
      most, all, json(diagnostics::results(errors)), quoted(diagnostics::error_summary(named)),
      quoted(diagnostics::best_change(named)), json(errors), json(position), diagnostics::findings_as_json(),
      phases());
  base::write_file(job_.output_folder / summary_file, text);
}

}  // namespace couplet::app
