// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/elements.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "thermocline/model/model.hpp"
#include "thermocline/model/tank.hpp"

namespace couplet::thermocline {
namespace {

std::string books_of(const char* element, double taken, double passed, double stored) {
  return fmt::format(
      "{}: {:.4g} MWh taken from the tank, {:.4g} MWh passed on; energy balance error {:.1e} of that",
      element, taken / 3.6e9, passed / 3.6e9,
      std::abs(stored - taken + passed) / std::max(std::abs(taken) + std::abs(passed), 1e-300));
}

/// One value per place; nullptr if not given yet.
const std::vector<double>* find(const coupling::Exchange& in, const char* name) {
  const auto found = in.find(name);
  return found == in.end() ? nullptr : &found->second;
}

std::string other_length(const std::vector<double>* told, const char* key, double own, double slack,
                         const char* where) {
  if (!told || told->empty() || !(std::abs(told->front() - own) > slack * own)) return "";
  return fmt::format("{} is {:.6g} m, but that of the tank is {:.6g} m{}", key, own, told->front(), where);
}

class GroundModel {
 public:
  GroundModel(const GroundElementParameters& p, const Weather& weather)
      : p_(p),
        deep_(weather.mean_temperature()),
        column_(ground_layers(p.ground), 0.25 * std::numbers::pi * p.diameter * p.diameter) {
    column_.set_steady(p.initial_temperature, deep_);
    start_ = column_.energy(deep_);
  }
  coupling::Interface describe() const {
    coupling::Interface i;
    i.face_centres = {{0, 0, 0}};
    i.face_areas = {{0, 0, column_.area()}};
    i.takes = {{"bottom-temperature", "K", coupling::Interface::Place::faces, 1},
               {"bottom-coefficient", "W/(m^2 K)", coupling::Interface::Place::faces, 1},
               {"tank-diameter", "m", coupling::Interface::Place::faces, 1}};
    i.gives = {{"bottom-heat", "W", coupling::Interface::Place::faces, 1}};
    return i;
  }
  /// Mismatch between the geometry here and that of the tank, as a sentence; empty if there is none.
  std::string contradiction(const coupling::Exchange& in) const {
    return other_length(find(in, "tank-diameter"), "diameter", p_.diameter, 1e-3, " (inside)");
  }
  coupling::Exchange advance(const coupling::Step& step, const coupling::Exchange& in, const Weather&) {
    const auto *temperature = find(in, "bottom-temperature"), *coefficient = find(in, "bottom-coefficient");
    const Film plate{coefficient ? coefficient->front() : 0,
                     temperature ? temperature->front() : p_.initial_temperature};
    const Film deep{std::numeric_limits<double>::infinity(), deep_};
    const int parts = std::max(1, int(std::ceil(step.dt / p_.ground.step * (1 - 1e-9))));
    double entered = 0;
    for (int k = 0; k < parts; ++k) {
      const Column::ColumnHeat heat = column_.step(step.dt / parts, plate, deep);
      entered += heat.inner, passed_ += heat.outer;
    }
    taken_ += entered;
    return {{"bottom-heat", {entered / step.dt}}};
  }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(taken_, passed_, start_);
    visit_values(numbers, column_.temperature());
  }
  std::string books() const { return books_of("ground", taken_, passed_, column_.energy(deep_) - start_); }

 private:
  GroundElementParameters p_;
  double deep_;
  Column column_;
  double start_ = 0, taken_ = 0, passed_ = 0;  // [J]
};

class BlanketModel {
 public:
  BlanketModel(const BlanketElementParameters& p, const Weather& weather)
      : p_(p),
        dz_(p.sections, p.height / p.sections),
        wall_(p.sections, p.initial_temperature),
        heat_(p.sections, 0.0),
        blanket_(p.insulation, dz_, p.diameter / 2) {
    air_ = weather.at(0).temperature;
    blanket_.set_steady(wall_, air_);
    start_ = blanket_.energy(air_);
  }
  coupling::Interface describe() const {
    coupling::Interface i;
    const double area = std::numbers::pi * p_.diameter * dz_[0];
    for (int k = 0; k < p_.sections; ++k) {
      i.face_centres.emplace_back(p_.diameter / 2, 0, (k + 0.5) * dz_[0]);
      i.face_areas.emplace_back(-area, 0, 0);
    }
    i.takes = {{"wall-temperature", "K", coupling::Interface::Place::faces, 1},
               {"wall-diameter", "m", coupling::Interface::Place::faces, 1},
               {"wall-height", "m", coupling::Interface::Place::faces, 1}};
    i.gives = {{"wall-heat", "W", coupling::Interface::Place::faces, 1}};
    return i;
  }
  std::string contradiction(const coupling::Exchange& in) const {
    std::string problem = other_length(find(in, "wall-diameter"), "diameter", p_.diameter, 0.02,
                                       " (outside of the lowest plate)");
    return problem.empty() ? other_length(find(in, "wall-height"), "height", p_.height, 1e-3,
                                          " of wall (its rings, bed and ullage)")
                           : problem;
  }
  coupling::Exchange advance(const coupling::Step& step, const coupling::Exchange& in,
                             const Weather& weather) {
    if (const auto* wall = find(in, "wall-temperature")) wall_ = *wall;
    const Ambient air = weather.at(step.time + step.dt / 2);
    const double outer = p_.diameter + 2 * p_.insulation.thickness;
    const Film film = side_film_on(blanket_, outer, p_.height, air);
    passed_ += blanket_.step(step.dt, wall_, film, heat_);
    for (const double q : heat_) taken_ += q * step.dt;
    return {{"wall-heat", heat_}};
  }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(taken_, passed_, start_, air_);
    visit_values(numbers, wall_, blanket_.temperature());
  }
  std::string books() const {
    return books_of("insulation", taken_, passed_, blanket_.energy(air_) - start_);
  }

 private:
  BlanketElementParameters p_;
  std::vector<double> dz_, wall_, heat_;
  Insulation blanket_;
  double air_ = 0, start_ = 0, taken_ = 0, passed_ = 0;  // [K], [J]
};

/// Common part of both: a state that changes only with accepted steps. Rank 0 has the data and computes.
template <class Model>
class ElementParticipant final : public coupling::Participant {
 public:
  template <class Parameters>
  ElementParticipant(const Parameters& p, const app::ParticipantContext& context)
      : weather_(make_weather(p.ambient, context.case_folder)),
        accepted_(p, *weather_),
        next_(accepted_),
        comm_(context.comm),
        name_(context.name) {
    if (!context.coupled)
      throw Error(
          "participants.{}: an element of a tank cannot run without that tank. Start it together with a "
          "coupler and a thermocline that has 'elsewhere'.",
          context.name);
    for (const std::string& sentence : weather_->doubts())
      diagnostics::finding(
          parallel::comm_rank(comm_),
          {.id = "questionable-plant", .sentence = fmt::format("{}: {}", context.name, sentence)});
  }
  coupling::Interface initialise() override {
    coupling::Interface all = accepted_.describe();
    if (parallel::comm_rank(comm_) != 0)
      all.face_centres.clear(), all.face_areas.clear();  // all take the same
    return all;
  }
  void begin_step(const coupling::Step& step) override { step_ = step; }
  coupling::Exchange solve(const coupling::Exchange& in) override {
    next_ = accepted_;
    std::string problem = parallel::comm_rank(comm_) == 0 ? accepted_.contradiction(in) : "";
    parallel::broadcast(comm_, problem);
    if (!problem.empty()) throw Error("participants.{}.{}.", name_, problem);
    return parallel::comm_rank(comm_) == 0 ? next_.advance(step_, in, *weather_) : coupling::Exchange{};
  }
  coupling::StepReport accept_step() override {
    std::swap(accepted_, next_);
    return {.dt = step_.dt};
  }
  void save(io::CheckpointWriter& file) const override {
    io::Archive(file).common("element", const_cast<Model&>(accepted_));  // writing changes nothing
  }
  void load(io::CheckpointReader& file) override { io::Archive(file).common("element", accepted_); }
  void write_output(double, int) override {}
  void write_monitors(double) override {}
  std::vector<std::string> finish() override { return {accepted_.books()}; }

 private:
  std::unique_ptr<Weather> weather_;
  Model accepted_, next_;
  coupling::Step step_;
  MPI_Comm comm_;
  std::string name_;
};

void check_weather(const WeatherParameters& ambient, const std::filesystem::path& folder,
                   std::vector<app::ProblemOfKey>& all) {
  const char* const key = ambient.kind == WeatherKind::file                                   ? "ambient.file"
                          : ambient.kind == WeatherKind::smooth_days && !ambient.file.empty() ? "ambient.air"
                                                                                              : "ambient";
  try {
    make_weather(ambient, folder);
  } catch (const Error& error) {
    all.push_back({key, error.what()});
  }
}

void declare_surroundings(config::Section& s, double& initial, WeatherParameters& ambient, const char* what) {
  s.value("initial-temperature", initial).unit("K", 70, 5000).positive().required().doc(what);
  s.section(
      "ambient", [&ambient](config::Section& q) { declare(q, ambient); }, "weather");
}

}  // namespace

void declare(config::Section& s, GroundElementParameters& p) {
  as_tank_length(s.value("diameter", p.diameter)).doc("inner diameter of the tank");
  s.section(
      "ground", [&p](config::Section& q) { declare(q, p.ground); }, "foundation and soil under the tank");
  declare_surroundings(s, p.initial_temperature, p.ambient,
                       "temperature of the tank's bottom, with which the ground starts in a steady state");
}

void declare(config::Section& s, BlanketElementParameters& p) {
  as_tank_length(s.value("diameter", p.diameter)).doc("outer diameter of the wall");
  as_tank_length(s.value("height", p.height)).doc("height of the wall");
  s.value("sections", p.sections).range(1, 100000).doc("number of sections along the wall");
  s.section(
      "insulation", [&p](config::Section& q) { declare(q, p.insulation); }, "blanket around the wall");
  declare_surroundings(s, p.initial_temperature, p.ambient,
                       "temperature of the wall, with which the blanket starts in a steady state");
}

void declare(config::Section& section, ElementParameters& p) {
  using Type = ElementParameters::Type;
  section.variant<Type>(
      "element", p.type,
      {{"tank", Type::tank, [&p](config::Section& s) { declare(s, p.tank); }},
       {"ground", Type::ground, [&p](config::Section& s) { declare(s, p.ground); }},
       {"insulation", Type::insulation, [&p](config::Section& s) { declare(s, p.blanket); }}},
      "a tank, or one element of a tank that another thermocline computes (elsewhere)");
}

TankParameters with_files(TankParameters p, const std::filesystem::path& folder) {
  if (p.flow.type != FlowParameters::Type::schedule || p.flow.file.empty()) return p;
  const std::filesystem::path file = folder / p.flow.file;
  p.flow.rows = read_flow_file(file);
  if (const std::string problem = problem_of_rows(p.flow); !problem.empty())
    throw Error("{}: the rows: {}.", file.string(), problem);
  if (const std::string problem = forgotten_unit_of_flow(p); !problem.empty())
    throw Error("{}: {}: here, in the column header.", file.string(), problem);
  return p;
}

std::vector<app::ProblemOfKey> problems_of_files(const ElementParameters& p,
                                                 const std::filesystem::path& folder) {
  std::vector<app::ProblemOfKey> all;
  switch (p.type) {
    case ElementParameters::Type::tank:
      check_weather(p.tank.ambient, folder, all);
      try {
        (void)with_files(p.tank, folder);
      } catch (const Error& error) {
        all.push_back({"flow.file", error.what()});
      }
      break;
    case ElementParameters::Type::ground:
      check_weather(p.ground.ambient, folder, all);
      break;
    case ElementParameters::Type::insulation:
      check_weather(p.blanket.ambient, folder, all);
      break;
  }
  return all;
}

std::unique_ptr<coupling::Participant> make_element(const ElementParameters& p,
                                                    const app::ParticipantContext& context) {
  if (p.type == ElementParameters::Type::ground)
    return std::make_unique<ElementParticipant<GroundModel>>(p.ground, context);
  if (p.type == ElementParameters::Type::insulation)
    return std::make_unique<ElementParticipant<BlanketModel>>(p.blanket, context);
  return std::make_unique<Tank>(with_files(p.tank, context.case_folder), context);
}

}  // namespace couplet::thermocline
