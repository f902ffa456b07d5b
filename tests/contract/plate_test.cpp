// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/body/rigid_body.hpp"
#include "plate_modal/structure.hpp"
#include "tests/contract/contract_suite.hpp"

namespace couplet::contract {
using namespace coupling;
namespace {

/// A clamped plate, wetted on both sides and its free rims; with a seat that it presses on.
template <bool Seat>
struct PlateFactory {
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    plate::Parameters p;
    p.material = {3000, 4e6, 0.3};
    p.thickness = 0.1;
    p.number = 8;
    p.damping.emplace().ratio = 0.01;
    for (const char* side : {"xmin", "xmax", "ymax"}) p.boundaries[side];
    p.boundaries["ymin"].support = plate::Support::clamped;
    if (Seat) {
      p.contact.emplace();
      p.contact->height.text = "-0.0501";
      p.contact->stiffness = 1e5;
    } else {
      p.time_scheme.type = time::TimeScheme::bathe;
    }
    static const mesh::RawMesh raw =
        mesh::make_box(mesh::BoxCells::quadrilaterals, {4, 5, 1}, Vec3::Zero(), Vec3(1, 1, 0));
    plate::PlateContext context;
    context.comm = comm;
    return std::make_unique<plate::Structure>(p, context, &raw);
  }
  static Exchange input(const Interface& interface, double factor) {
    Exchange in;
    for (const Vec3& area : interface.face_areas)
      for (int c = 0; c < 3; ++c) {
        in["pressure-force"].push_back(area.z() > 0 ? -50 * factor * area[c] : 0);
        in["viscous-force"].push_back(c == 1 ? factor * area.norm() : 0);
      }
    return in;
  }
  static constexpr Scheme scheme = Scheme::implicit;
  static constexpr double dt = 0.01, repeat_tolerance = 0, rank_tolerance = 1e-10, restart_tolerance = 0;
};
/// A rigid box on springs that rotates freely; or a planar one on a hinge with a stop that it presses on.
template <int Dimension>
struct BodyFactory {
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    plate::Parameters p;
    plate::BodyParameters& body = p.body.emplace();
    body.dimension = Dimension;
    body.mass = 2;
    body.center_of_mass = Vec3(0.5, 0.4, 0);
    body.surface = {"xmin", "xmax", "ymin", "ymax"};
    if (Dimension == 2) {
      body.inertia = {0.2};
      body.hinge.emplace();
      plate::Stop& stop = body.stops.emplace().rotation.emplace();
      stop.most = 0, stop.stiffness = 1e4, stop.restitution = 0.5;
    } else {
      body.inertia = {0.3, 0.4, 0.5};
      body.springs.emplace().rotation = {20, 30, 40};
      body.springs->translation = Vec3(100, 200, 300);
      body.initial_angular_velocity = Vec3(1, 2, 3);
    }
    const auto cells = Dimension == 2 ? mesh::BoxCells::quadrilaterals : mesh::BoxCells::hexahedra;
    static const mesh::RawMesh raw =
        mesh::make_box(cells, {4, 5, 2}, Vec3::Zero(), Vec3(1, 1, Dimension == 2 ? 0 : 1));
    plate::PlateContext context;
    context.comm = comm;
    return std::make_unique<plate::RigidBody>(p, context, &raw);
  }
  static Exchange input(const Interface& interface, double factor) {
    Exchange in;
    for (const Vec3& area : interface.face_areas)
      for (int c = 0; c < Dimension; ++c) {
        in["pressure-force"].push_back(area.x() > 0 ? -50 * factor * area[c] : 0);
        in["viscous-force"].push_back(c == 1 ? factor * area.norm() : 0);
      }
    return in;
  }
  static Exchange hopeless(const Interface& interface) {
    return input(interface, std::numeric_limits<double>::quiet_NaN());
  }
  static constexpr Scheme scheme = Scheme::implicit;
  static constexpr double dt = 0.01, repeat_tolerance = 0, rank_tolerance = 0, restart_tolerance = 0;
};
using BodyOnHinge = BodyFactory<2>;
using FreeBody = BodyFactory<3>;

using Plate = PlateFactory<false>;
using PlateOnSeat = PlateFactory<true>;

INSTANTIATE_TYPED_TEST_SUITE_P(Plate, ParticipantContract, Plate);
INSTANTIATE_TYPED_TEST_SUITE_P(PlateOnSeat, ParticipantContract, PlateOnSeat);
INSTANTIATE_TYPED_TEST_SUITE_P(BodyOnHinge, ParticipantContract, BodyOnHinge);
INSTANTIATE_TYPED_TEST_SUITE_P(FreeBody, ParticipantContract, FreeBody);

}  // namespace
}  // namespace couplet::contract
