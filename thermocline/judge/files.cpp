// SPDX-License-Identifier: Apache-2.0
#include "thermocline/judge/files.hpp"

#include "common/base/error.hpp"
#include "thermocline/model/questions.hpp"
#include "thermocline/plant/flow.hpp"

namespace couplet::thermocline {
namespace {

void look_at_weather(const WeatherParameters& ambient, const std::optional<InsulationParameters>& blanket,
                     const std::filesystem::path& folder, std::vector<app::ProblemOfKey>& all) {
  const char* const key = ambient.kind == WeatherKind::file                                   ? "ambient.file"
                          : ambient.kind == WeatherKind::smooth_days && !ambient.file.empty() ? "ambient.air"
                                                                                              : "ambient";
  std::unique_ptr<Weather> weather;
  try {
    weather = make_weather(ambient, folder);
  } catch (const Error& error) {
    all.push_back({key, error.what()});
    return;
  }
  if (!blanket) return;
  const std::string absorptance = "insulation.solar-absorptance";
  try {
    require_sun(blanket->outside.solar_absorptance, *weather, absorptance);
  } catch (const Error& error) {
    all.push_back({absorptance, std::string(error.what()).substr(absorptance.size() + 2)});
  }
}

}  // namespace

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
      look_at_weather(p.tank.ambient, p.tank.insulation, folder, all);
      try {
        (void)with_files(p.tank, folder);
      } catch (const Error& error) {
        all.push_back({"flow.file", error.what()});
      }
      break;
    case ElementParameters::Type::ground:
      look_at_weather(p.ground.ambient, {}, folder, all);
      break;
    case ElementParameters::Type::insulation:
      look_at_weather(p.blanket.ambient, p.blanket.insulation, folder, all);
      break;
  }
  return all;
}

}  // namespace couplet::thermocline
