// SPDX-License-Identifier: Apache-2.0
#include "common/app/loop/step_loop.hpp"

#include <fmt/format.h>

#include "common/coupling/step_plan.hpp"
#include "common/diagnostics/finding.hpp"

namespace couplet::app {

namespace {

void declare_fields(config::Section& s, io::FieldChoice& f) {
  s.value("every", f.every)
      .range(0, 1000000)
      .doc(
          "volume fields are written only at every n-th output, whereas surfaces, samples and the interface are written at "
          "each output; 0 writes no volume fields");
  s.value("compression", f.compression)
      .range(0, 9)
      .doc("deflate compression level of the volume fields: 0 (none), 1 (fastest) to 9 (smallest files)");
  s.optional_section<io::FieldChoice::Box>(
      "box", f.box,
      [](config::Section& b, io::FieldChoice::Box& box) {
        b.value("from", box.from).unit("m", 1e-9, 1e4).required().doc("corner with the smallest coordinates");
        b.value("to", box.to)
            .unit("m", 1e-9, 1e4)
            .required()
            .doc("corner with the largest coordinates; in two dimensions the third number is ignored");
        b.check(
            [&box] {
              return (box.to - box.from).minCoeff() < 0
                         ? "none of its coordinates may be below that of 'from'"
                         : "";
            },
            "to");
      },
      "volume fields are written only for cells that are initially inside this box; default: all cells");
}

void declare_files(config::Section& section, SimulationParameters& p) {
  section.section(
      "output",
      [&](config::Section& s) {
        s.value("folder", p.output_folder)
            .doc(
                "output folder, in which each participant creates a subfolder; relative to the folder of the YAML file");
        s.check(
            [&p] {
              const bool is_of_a_shell =
                  p.output_folder.starts_with('~') || p.output_folder.find('$') != std::string::npos;
              return is_of_a_shell
                         ? "'~' and '$' are not expanded here as they are by a shell; write the full path"
                         : "";
            },
            "folder");
        s.value("interval", p.output_interval)
            .unit("s", 1e-12, 1e10)
            .not_negative()
            .doc("time between field outputs; with 0, fields are written only at the start and the end");
        s.value("steps", p.output_steps)
            .doc(
                "write steps.csv, which lists the iterations, error, energy and wall time of each accepted step");
        declare_fields(s, p.fields);
      },
      "fields for visualization");
  section.section(
      "checkpoint",
      [&](config::Section& s) {
        s.value("interval", p.checkpoint_interval)
            .unit("s", 1e-12, 1e10)
            .not_negative()
            .doc("time between checkpoints; 0 means only at the end of the run");
        s.value("keep", p.checkpoints_kept)
            .range(1, 1000000)
            .doc("number of most recent checkpoints to keep");
      },
      "checkpoints, from which --restart continues");
}

}  // namespace

void declare(config::Section& section, SimulationParameters& p) {
  section.value("name", p.name).doc("name of the case, shown at the start of a run");
  section.value("end-time", p.end_time)
      .unit("s", 1e-10, 1e11)
      .positive()
      .required()
      .doc("end time of the run");
  section.value("time-step", p.time_step)
      .unit("s", 1e-13, 1e8)
      .positive()
      .required()
      .doc("time step of the run; in a coupled run the coupling step, which a participant may subdivide");
  section.value("until-steady", p.until_steady)
      .range(1e-12, 0.1)
      .doc(
          "end the run before 'end-time' once the distance from the steady state, estimated from the changes of six equal steps, is "
          "below this share of the solution in all programs that tell (fluid_solver, solid_solver); conditions that change later are not foreseen. Default: never");
  section.value("max-step-halvings", p.max_step_halvings)
      .range(0, 20)
      .doc(
          "maximum number of halvings of a step that could not be solved; ten halvings for one cause "
          "without full steps in between also stop the run");
  section.value("accept", p.accept)
      .doc(
          "ids of findings (docs/findings.md) to accept: they are logged, but neither end the run with exit "
          "code 4 nor make it fail with --strict");
  section.check([&]() -> std::string { return diagnostics::unknown_ids(p.accept); }, "accept");
  section.value("neglected-limit", p.neglected_share)
      .range(0, 1)
      .doc(
          "relative change of the result from which a neglected effect matters: below it the run says 'justified', at or "
          "above it 'matters' (docs/findings.md)");
  section.choice("effects", p.choose_effects, {{"as-given", false}, {"auto", true}})
      .doc(
          "auto: dimension, inertia, turbulence model and viscous treatment that the case does not set are "
          "chosen from estimates; each choice is logged with its reason");
  using diagnostics::When;
  section
      .choice("diagnostics", p.diagnostics,
              {{"without-errors", When::always}, {"standard", When::with_errors}, {"full", When::in_full}})
      .doc(
          "what the run checks about its own result. standard: findings and the error due to mesh, time step and "
          "tolerances; without-errors: findings only; full: also searches that may take as long as a solve (all low "
          "buckling loads, stability in each step)");
  section.value("hang-timeout", p.hang_timeout)
      .unit("s", 1, 1e6)
      .not_negative()
      .doc(
          "the job ends and names the process responsible if a process shows no sign of activity for this long (an iteration "
          "of a solver, a phase of a step, or processor time during meshing, factorization and file output); 0 means never");
  declare_files(section, p);
  section.check(
      [&]() -> std::string {
        if (p.time_step > p.end_time) return "the time step must not be longer than the run ('end-time')";
        const double steps = p.end_time / p.time_step;
        if (steps <= coupling::StepPlan::most_steps) return "";
        return fmt::format("the run would take {:g} steps; at most {:g} are allowed", steps,
                           coupling::StepPlan::most_steps);
      },
      "time-step");
}

}  // namespace couplet::app
