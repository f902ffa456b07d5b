// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/base/error.hpp"
#include "thermocline/model/model.hpp"

namespace couplet::thermocline {
namespace {

void replace(const std::string& name, const std::vector<double>& from, std::vector<double>& to) {
  if (from.size() != to.size())
    throw Error(
        "The checkpoint's '{}' has {} values, this tank needs {}; run with the same elements and cells.",
        name, from.size(), to.size());
  to = from;
}

}  // namespace

std::vector<std::pair<std::string, std::vector<double>>> TankModel::state() const {
  std::vector<std::pair<std::string, std::vector<double>>> all;
  all.emplace_back("bed", bed_.state());
  if (shell_)
    all.emplace_back("shell",
                     std::vector<double>(shell_->temperature().begin(), shell_->temperature().end()));
  if (shell_) all.emplace_back("owed-to-shell", owed_);
  if (mechanics_) all.emplace_back("filler-mechanics", mechanics_->state());
  if (contact_) all.emplace_back("contact", contact_->state());
  if (insulation_) all.emplace_back("insulation", insulation_->temperature());
  const bool blanket = insulation_ || (setup_->parameters.elsewhere && shell_);
  if (blanket) all.emplace_back("into-blanket", into_blanket_);
  if (roof_) all.emplace_back("roof", roof_->temperature());
  if (ground_) all.emplace_back("ground", ground_->temperature());
  if (ullage_) {
    const auto gas = ullage_->state();
    all.emplace_back("ullage", std::vector<double>{gas[0], gas[1], from_liquid_, wall_to_ullage_});
  }
  all.emplace_back("flow-of-closures", std::vector<double>{bed_.prepared().dt, bed_.prepared().mass_flow});
  all.emplace_back("closures",
                   std::vector<double>(bed_.wall_coefficient().begin(), bed_.wall_coefficient().end()));
  const Ledger& l = ledger_;
  all.emplace_back("books", std::vector<double>{side_.until,  side_.in,        side_.out,  soil_.until,
                                                soil_.in,     soil_.out,       l.flow,     l.side,
                                                l.roof,       l.ground,        l.bed,      l.turnover,
                                                reference_,   start_energy_,   start_bed_, inversion_.depth,
                                                inversion_.z, inversion_.time, coldest_,   hottest_});
  return all;
}

void TankModel::restore(const std::function<std::vector<double>(const std::string&)>& read) {
  bed_.restore(read("bed"));
  if (shell_) update_pressure();
  if (shell_) {
    std::vector<double> wall(shell_->temperature().begin(), shell_->temperature().end());
    replace("shell", read("shell"), wall);
    shell_->set_temperature(wall);
  }
  if (shell_) replace("owed-to-shell", read("owed-to-shell"), owed_);
  if (mechanics_) mechanics_->restore(read("filler-mechanics"));
  if (contact_) contact_->restore(read("contact"));
  if (insulation_) replace("insulation", read("insulation"), insulation_->temperature());
  if (insulation_ || (setup_->parameters.elsewhere && shell_))
    replace("into-blanket", read("into-blanket"), into_blanket_);
  if (roof_) replace("roof", read("roof"), roof_->temperature());
  if (ground_) replace("ground", read("ground"), ground_->temperature());
  if (ullage_) {
    const std::vector<double> gas = read("ullage");
    ullage_->restore(gas.at(0), gas.at(1));
    from_liquid_ = gas.at(2), wall_to_ullage_ = gas.at(3);
  }
  const std::vector<double> flow = read("flow-of-closures");
  bed_.prepare(flow.at(0), flow.at(1));
  bed_.set_wall_coefficient(read("closures"));
  const std::vector<double> b = read("books");
  side_ = {b.at(0), b.at(1), b.at(2)};
  soil_ = {b.at(3), b.at(4), b.at(5)};
  ledger_ = {b.at(6), b.at(7), b.at(8), b.at(9), b.at(10), b.at(11)};
  reference_ = b.at(12), start_energy_ = b.at(13), start_bed_ = b.at(14);
  inversion_ = {b.at(15), b.at(16), b.at(17)};
  coldest_ = b.at(18), hottest_ = b.at(19);
  update_stress();
}

}  // namespace couplet::thermocline
