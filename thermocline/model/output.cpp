// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/tank.hpp"

#include <cmath>
#include <limits>

namespace couplet::thermocline {
namespace {

/// Largest ratio of equivalent stress to yield strength, and the height of its ring [m].
std::pair<double, double> worst_stress(const TankModel& m) {
  double worst = 0, place = 0;
  if (!m.shell()) return {0, 0};
  const WallStress& s = m.stress();
  for (std::size_t i = 0; i < s.equivalent.size(); ++i)
    if (s.equivalent[i] > worst * s.yield[i])
      worst = s.equivalent[i] / s.yield[i], place = m.setup().rings->z[i];
  return {worst, place};
}

/// Temperature of the flow [degC]; undefined at rest.
double flowing(const BedStep& step, double kelvin) {
  return step.flow.mass_flow != 0 ? celsius(kelvin) : std::numeric_limits<double>::quiet_NaN();
}

/// Value of a ring next to grains; 0 above them and without filler mechanics.
template <class Values>
double beside_grains(const TankModel& m, std::size_t ring, Values values) {
  const FillerMechanics* filler = m.mechanics();
  return filler && ring < filler->contact().size() ? double(values(*filler)[ring]) : 0;
}

}  // namespace

std::vector<OutputColumn<TankOutputFiles::Moment>> TankOutputFiles::quantities_of(const TankModel& model) {
  std::vector<OutputColumn<Moment>> all{
      {"time [s]", [](const Moment& v) { return v.time; }},
      {"mass flow [kg/s]", [](const Moment& v) { return v.last.flow.mass_flow; }},
      {"inlet [degC]", [](const Moment& v) { return flowing(v.last, v.last.flow.inlet_temperature); }},
      {"outlet [degC]", [](const Moment& v) { return flowing(v.last, v.last.outlet_temperature); }},
      {"top [degC]", [](const Moment& v) { return celsius(v.m.bed().top()); }},
      {"bottom [degC]", [](const Moment& v) { return celsius(v.m.bed().bottom()); }},
      {"heat by flow [J]", [](const Moment& v) { return v.m.ledger().flow; }},
      {"loss side [J]", [](const Moment& v) { return v.m.ledger().side; }},
      {"loss roof [J]", [](const Moment& v) { return v.m.ledger().roof; }},
      {"loss ground [J]", [](const Moment& v) { return v.m.ledger().ground; }},
      {"imbalance [J]", [](const Moment& v) { return v.m.imbalance(v.time); }},
      {"largest equivalent stress over yield [1]", [](const Moment& v) { return worst_stress(v.m).first; }},
      {"at z [m]", [](const Moment& v) { return worst_stress(v.m).second; }}};
  if (model.setup().parameters.pump) {
    all.push_back({"pressure loss [Pa]", [](const Moment& v) { return v.last.pressure_loss; }});
    all.push_back({"pump [W]", [](const Moment& v) { return v.last.pump_power; }});
  }
  return all;
}

TankOutputFiles::TankOutputFiles(const TankModel& model, const std::filesystem::path& folder,
                                 double restart_time)
    : tank_(folder / "tank.csv", quantities_of(model), restart_time),
      bed_(folder / "bed.csv",
           {{"time [s]", [](const CellMoment& v) { return v.time; }},
            {"z [m]", [](const CellMoment& v) { return v.m.bed().grid().z[v.i]; }},
            {"fluid [degC]", [](const CellMoment& v) { return celsius(v.m.bed().fluid()[v.i]); }},
            {"filler [degC]", [](const CellMoment& v) { return celsius(v.filler[v.i]); }}},
           restart_time),
      interval_(model.setup().parameters.output.monitor_interval) {
  if (model.shell())
    wall_.emplace(
        folder / "wall.csv",
        std::vector<OutputColumn<CellMoment>>{
            {"time [s]", [](const CellMoment& v) { return v.time; }},
            {"z [m]", [](const CellMoment& v) { return v.m.setup().rings->z[v.i]; }},
            {"wall [degC]", [](const CellMoment& v) { return celsius(v.m.shell()->temperature()[v.i]); }},
            {"hoop stress [Pa]", [](const CellMoment& v) { return v.m.stress().hoop[v.i]; }},
            {"equivalent stress [Pa]", [](const CellMoment& v) { return v.m.stress().equivalent[v.i]; }},
            {"yield strength [Pa]", [](const CellMoment& v) { return v.m.stress().yield[v.i]; }},
            {"filler pressure [Pa]",
             [](const CellMoment& v) {
               return beside_grains(v.m, v.i, [](const FillerMechanics& filler) { return filler.lateral(); });
             }},
            {"contact [0 active; 1 rigid; 2 passive]",
             [](const CellMoment& v) {
               return beside_grains(v.m, v.i, [](const FillerMechanics& filler) { return filler.contact(); });
             }}},
        restart_time);
  if (model.ground())
    ground_.emplace(folder / "ground.csv",
                    std::vector<OutputColumn<CellMoment>>{
                        {"time [s]", [](const CellMoment& v) { return v.time; }},
                        {"depth [m]", [](const CellMoment& v) { return v.m.ground()->centre()[v.i]; }},
                        {"temperature [degC]",
                         [](const CellMoment& v) { return celsius(v.m.ground()->temperature()[v.i]); }}},
                    restart_time);
  // A continued run writes at the same times as the previous one.
  if (!std::isnan(restart_time)) next_ = after(restart_time);
}

double TankOutputFiles::after(double time) const {
  return interval_ > 0 ? (std::floor(time / interval_ * (1 + 1e-12)) + 1) * interval_ : 0;
}

void TankOutputFiles::monitor(const TankModel& model, double time, const BedStep& last) {
  if (time < next_ - 1e-9 * interval_) return;
  next_ = after(time);
  tank_.row({model, time, last});
}

void TankOutputFiles::profiles(const TankModel& model, double time) {
  std::vector<double> filler;
  model.bed().filler_temperature(filler);
  const auto write = [&](QuantityFile<CellMoment>& file, std::size_t places) {
    for (std::size_t i = 0; i < places; ++i) file.row({model, time, i, filler});
  };
  write(bed_, filler.size());
  if (wall_) write(*wall_, model.setup().rings->z.size());
  if (ground_) write(*ground_, model.ground()->centre().size());
}

}  // namespace couplet::thermocline
