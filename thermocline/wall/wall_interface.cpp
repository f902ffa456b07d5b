// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/wall_interface.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::thermocline {

void declare(config::Section& s, ExternalWallParameters& p) {
  s.value("sections", p.sections)
      .range(2, 100000)
      .doc("number of faces along the wall, equal to that of the other program's inner surface");
  s.value("angle", p.angle)
      .unit("rad")
      .range(1e-6, 3)
      .doc(
          "angle of the wedge that the other program "
          "computes");
}

WallInterface::WallInterface(const ExternalWallParameters& p, const Rings& rings)
    : radius_(rings.diameter / 2),
      angle_(p.angle),
      height_(rings.z.back() + rings.dz.back() / 2),
      sections_(p.sections),
      ring_z_(rings.z),
      ring_dz_(rings.dz) {}

coupling::Interface WallInterface::describe() const {
  coupling::Interface interface;
  interface.dim = 3;
  const double dz = height_ / sections_, half = angle_ / 2, width = 2 * radius_ * std::sin(half);
  for (int k = 0; k <= sections_; ++k)
    for (const double side : {-1.0, 1.0})
      interface.vertices.emplace_back(radius_ * std::cos(half), side * radius_ * std::sin(half), k * dz);
  for (int k = 0; k < sections_; ++k) {
    interface.face_centres.emplace_back(radius_ * std::cos(half), 0, (k + 0.5) * dz);
    interface.face_areas.emplace_back(width * dz, 0, 0);
  }
  return interface;
}

std::vector<double> WallInterface::to_sections(std::span<const double> rings) const {
  const Table profile(ring_z_, {rings.begin(), rings.end()});
  std::vector<double> values(sections_);
  const double dz = height_ / sections_, from = ring_z_.front();
  for (int k = 0; k < sections_; ++k) {
    // The table is constant below its first ring; its integral counts from there.
    const double low = k * dz, high = low + dz;
    values[k] = high <= from ? profile(low) : (profile.integral(high) - profile.integral(low)) / dz;
  }
  return values;
}

std::vector<double> WallInterface::to_rings(std::span<const double> amounts) const {
  std::vector<double> values(ring_z_.size());
  const double dz = height_ / sections_;
  for (std::size_t i = 0; i < ring_z_.size(); ++i) {
    const double low = ring_z_[i] - ring_dz_[i] / 2, high = low + ring_dz_[i];
    const int last = std::min(sections_ - 1, int(high / dz));
    for (int k = std::max(0, int(low / dz)); k <= last; ++k)
      values[i] += amounts[k] * std::max(0.0, std::min(high, (k + 1) * dz) - std::max(low, k * dz)) / dz;
  }
  return values;
}

std::vector<double> WallInterface::radial(std::span<const double> displacement) const {
  if (displacement.size() != std::size_t(6 * (sections_ + 1)))
    throw Error("The wall gave {} values of displacement, but its {} vertices need {}.", displacement.size(),
                2 * (sections_ + 1), 6 * (sections_ + 1));
  std::vector<double> z, u;
  const double c = std::cos(angle_ / 2), s = std::sin(angle_ / 2);
  for (int k = 0; k <= sections_; ++k) {
    const double* d = displacement.data() + 6 * k;
    z.push_back(k * height_ / sections_);
    u.push_back(0.5 * ((d[0] * c - d[1] * s) + (d[3] * c + d[4] * s)));
  }
  const Table profile(std::move(z), std::move(u));
  std::vector<double> values;
  for (const double at : ring_z_) values.push_back(profile(at));
  return values;
}

ContactMechanics::ContactMechanics(const Rings& rings, const Steel& steel, const Filler& filler,
                                   const InnerPressure& p, std::span<const double> wall,
                                   std::span<const double> grains)
    : rings_(&rings),
      steel_(&steel),
      expansion_(filler.expansion),
      active_ratio_(rankine_active(filler)),
      grains_(grains.begin(), grains.end()),
      given_wall_(wall.begin(), wall.end()) {
  for (auto* v : {&fluid_, &active_, &passive_}) v->resize(rings.size());
  load(p);
  lateral_ = active_;
  strain_.assign(rings.in_bed, 0.0), slip_.assign(rings.in_bed, 0.0);
  contact_.assign(rings.in_bed, Contact::active);
  total_.resize(rings.size()), hoop_.resize(rings.size());
  finish();
}

void ContactMechanics::load(const InnerPressure& p) {
  for (std::size_t i = 0; i < fluid_.size(); ++i) {
    fluid_[i] = p.fluid[i];
    active_[i] = active_ratio_ * p.vertical[i];
    passive_[i] = p.vertical[i] / active_ratio_;
  }
}

void ContactMechanics::finish() {
  for (int i = 0; i < rings_->size(); ++i) {
    total_[i] = fluid_[i] + lateral_[i];
    hoop_[i] = total_[i] * rings_->diameter / (2 * rings_->thickness[i]);
  }
}

void ContactMechanics::update(std::span<const double> radial, std::span<const double> wall,
                              std::span<const double> grains) {
  const double radius = rings_->diameter / 2;
  for (int i = 0; i < rings_->in_bed; ++i) {
    const double stiffness = steel_->youngs_modulus(wall[i]) * rings_->thickness[i] / radius;
    const double free = steel_->thermal_strain(wall[i]);
    const double strain =
        radial.empty() ? total_[i] / stiffness + free
                       : std::log1p(radial[i] / radius) + free - steel_->thermal_strain(given_wall_[i]);
    if (!begun_) strain_[i] = strain;
    strain_[i] += expansion_ * (grains[i] - grains_[i]);
    grains_[i] = grains[i];
    const double wanted = lateral_[i] + stiffness * (strain_[i] - strain);
    lateral_[i] = std::clamp(wanted, active_[i], passive_[i]);
    contact_[i] = wanted <= active_[i]    ? Contact::active
                  : wanted >= passive_[i] ? Contact::passive
                                          : Contact::rigid;
    // Where the bound cuts the pressure, the filler ends where the wall will be under the bound.
    strain_[i] -= (wanted - lateral_[i]) / stiffness;
    slip_[i] += std::max(0.0, wanted - passive_[i]) / stiffness;
  }
  given_wall_.assign(wall.begin(), wall.end());
  begun_ = begun_ || !radial.empty();
  finish();
}

std::vector<double> ContactMechanics::state() const {
  std::vector<double> all{double(begun_)};
  for (const auto* v : {&strain_, &slip_, &grains_, &lateral_, &given_wall_})
    all.insert(all.end(), v->begin(), v->end());
  for (const Contact c : contact_) all.push_back(double(c));
  return all;
}

void ContactMechanics::restore(std::span<const double> state) {
  if (state.size() != 1 + 3 * strain_.size() + grains_.size() + lateral_.size() + given_wall_.size())
    throw Error("external-wall: the checkpoint has another number of rings; run with the same cells.");
  const double* from = state.data();
  begun_ = *from++ != 0;
  for (auto* v : {&strain_, &slip_, &grains_, &lateral_, &given_wall_})
    for (double& value : *v) value = *from++;
  for (Contact& c : contact_) c = Contact(int(*from++));
  finish();
}

}  // namespace couplet::thermocline
