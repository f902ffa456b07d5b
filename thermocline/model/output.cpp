// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/output.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace couplet::thermocline {
namespace {

std::vector<std::string> monitored(const TankModel& model) {
  std::vector<std::string> columns{
      "time [s]",      "mass flow [kg/s]", "inlet [degC]",     "outlet [degC]",
      "top [degC]",    "bottom [degC]",    "heat by flow [J]", "loss side [J]",
      "loss roof [J]", "loss ground [J]",  "imbalance [J]",    "largest equivalent stress over yield [1]",
      "at z [m]"};
  if (model.setup().parameters.pump) columns.insert(columns.end(), {"pressure loss [Pa]", "pump [W]"});
  return columns;
}

}  // namespace

TankOutputFiles::TankOutputFiles(const TankModel& model, const std::filesystem::path& folder,
                                 double restart_time)
    : tank_(folder / "tank.csv", monitored(model), restart_time),
      bed_(folder / "bed.csv", {"time [s]", "z [m]", "fluid [degC]", "filler [degC]"}, restart_time),
      interval_(model.setup().parameters.output.monitor_interval) {
  if (model.shell())
    wall_ = std::make_unique<io::Series>(
        folder / "wall.csv",
        std::vector<std::string>{"time [s]", "z [m]", "wall [degC]", "hoop stress [Pa]",
                                 "equivalent stress [Pa]", "yield strength [Pa]", "filler pressure [Pa]",
                                 "contact [0 active; 1 rigid; 2 passive]"},
        restart_time);
  if (model.ground())
    ground_ = std::make_unique<io::Series>(
        folder / "ground.csv", std::vector<std::string>{"time [s]", "depth [m]", "temperature [degC]"},
        restart_time);
  // A run that goes on writes where the one before would have.
  if (!std::isnan(restart_time)) next_ = after(restart_time);
}

double TankOutputFiles::after(double time) const {
  return interval_ > 0 ? (std::floor(time / interval_ * (1 + 1e-12)) + 1) * interval_ : 0;
}

void TankOutputFiles::monitor(const TankModel& model, double time, const BedStep& last) {
  if (time < next_ - 1e-9 * interval_) return;
  next_ = after(time);
  double worst = 0, place = 0;
  const WallStress& s = model.stress();
  for (std::size_t i = 0; i < s.equivalent.size(); ++i)
    if (s.equivalent[i] > worst * s.yield[i])
      worst = s.equivalent[i] / s.yield[i], place = model.setup().rings->z[i];
  const Ledger& l = model.ledger();
  // At rest nothing comes in and nothing leaves.
  const double none = std::numeric_limits<double>::quiet_NaN();
  const bool flows = last.flow.mass_flow != 0;
  std::vector<double> row{time,
                          last.flow.mass_flow,
                          flows ? celsius(last.flow.inlet_temperature) : none,
                          flows ? celsius(last.outlet_temperature) : none,
                          celsius(model.bed().top()),
                          celsius(model.bed().bottom()),
                          l.flow,
                          l.side,
                          l.roof,
                          l.ground,
                          model.imbalance(time),
                          worst,
                          place};
  if (model.setup().parameters.pump) row.insert(row.end(), {last.pressure_loss, last.pump_power});
  tank_.row(row);
}

void TankOutputFiles::profiles(const TankModel& model, double time) {
  std::vector<double> filler;
  model.bed().filler_temperature(filler);
  const BedGrid& grid = model.bed().grid();
  for (int i = 0; i < grid.size(); ++i)
    bed_.row(std::vector<double>{time, grid.z[i], celsius(model.bed().fluid()[i]), celsius(filler[i])});
  if (wall_) {
    const WallStress& s = model.stress();
    std::span<const double> lateral;
    std::span<const Contact> contact;
    if (model.mechanics()) lateral = model.mechanics()->lateral(), contact = model.mechanics()->contact();
    if (model.contact()) lateral = model.contact()->lateral(), contact = model.contact()->contact();
    for (int i = 0; i < model.setup().rings->size(); ++i) {
      const bool held = i < int(contact.size());
      wall_->row(std::vector<double>{time, model.setup().rings->z[i],
                                     celsius(model.shell()->temperature()[i]), s.hoop[i], s.equivalent[i],
                                     s.yield[i], held ? lateral[i] : 0, held ? double(contact[i]) : 0});
    }
  }
  if (ground_)
    for (std::size_t i = 0; i < model.ground()->centre().size(); ++i)
      ground_->row(
          std::vector<double>{time, model.ground()->centre()[i], celsius(model.ground()->temperature()[i])});
}

}  // namespace couplet::thermocline
