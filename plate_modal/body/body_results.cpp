// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/body/body_results.hpp"

#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "plate_modal/motion/surface.hpp"

namespace couplet::plate {

BodyResults::BodyResults(const RigidBody& body)
    : body_(body),
      active_(!body.context().output_folder.empty()),
      root_(parallel::comm_rank(body.context().comm) == 0),
      surface_(
          body.body().dimension == 3
              ? mesh_of_surface(body.context().comm, body.surface().vertices.size(), body.surface().faces)
              : mesh::Mesh()) {}

void BodyResults::row(std::optional<io::Series>& one, const char* file,
                      const std::vector<std::string>& columns, const std::vector<double>& values) {
  if (!one) one.emplace(body_.context().output_folder / file, columns, body_.context().restart_time);
  one->row(values);
}

void BodyResults::write_start() const {
  if (!root_) return;
  const BodyParameters& p = body_.body();
  std::vector<std::string> free;
  for (const char* word : {"x", "y", "z", "rotation-x", "rotation-y", "rotation-z"})
    if (!p.holds(word)) free.emplace_back(word);
  if (p.hinge) free.emplace_back("rotation about the hinge");
  const BodySurface& s = body_.surface();
  log::info("rigid body of {:.6g} kg, free: {}{}", p.mass, base::join(free),
            s.areas.empty() ? ""
                            : fmt::format("; its surface has {} faces and encloses {:.6g} m^3",
                                          s.areas.size(), s.enclosed));
  const double impact = body_.motion().shortest_impact(), steps = impact / body_.context().time_step;
  if (!std::isfinite(impact)) return;
  const std::string text =
      fmt::format("the shortest impact on a stop lasts {:.3g} s (pi sqrt(m / k))", impact);
  if (steps < 10)
    log::warn(
        "{}. The time step resolves it with only {:.2g} steps; twenty give the time of the rebound to 1 %: "
        "'simulation.time-step: {:.2g} s'.",
        text, steps, impact / 20);
  else
    log::info("{}.", text);
}

void BodyResults::write_fields(double time) {
  const bool any = parallel::any(body_.context().comm, !body_.surface().faces.index.empty());
  if (!active_ || !body_.parameters().output.fields || body_.body().dimension != 3 || !any) return;
  const std::vector<Vec3> none, &places = root_ ? body_.surface().vertices : none;
  const std::vector<double> u = body_.displacements(body_.state()), v = body_.velocities(body_.state());
  std::vector<Vec3> moved = places;
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += Vec3(&u[3 * i]);
  if (!fields_)
    fields_.emplace(surface_, places, body_.context().output_folder, body_.context().name, true,
                    body_.context().restart_time);
  fields_->write(time, moved,
                 {{"displacement", "m", io::OutputField::Place::points, 3, u},
                  {"velocity", "m/s", io::OutputField::Place::points, 3, v}});
}

void BodyResults::write_series(double time) {
  if (!active_ || !root_) return;
  const BodyState& now = body_.state();
  const BodyMotion& motion = body_.motion();
  const Tensor3 mean = 0.5 * (now.rotation() + body_.before().rotation());
  std::vector<double> values{time};
  for (const Vec3& v : {now.translation, now.turned, motion.reference_velocity(now), now.angular_velocity(),
                        body_.load().force, body_.load().about_reference(mean)})
    values.insert(values.end(), v.data(), v.data() + 3);
  row(motion_, "body.csv",
      {"time [s]", "displacement x [m]", "displacement y [m]", "displacement z [m]", "rotation x [rad]",
       "rotation y [rad]", "rotation z [rad]", "velocity x [m/s]", "velocity y [m/s]", "velocity z [m/s]",
       "angular velocity x [rad/s]", "angular velocity y [rad/s]", "angular velocity z [rad/s]",
       "force x [N]", "force y [N]", "force z [N]", "moment x [N m]", "moment y [N m]", "moment z [N m]"},
      values);
  const Energies& e = now.energies;
  row(energies_, "energies.csv",
      {"time [s]", "kinetic [J]", "strain [J]", "gravity [J]", "seat [J]", "work of loads [J]",
       "work of impact [J]", "damping loss [J]", "mismatch [J]"},
      {time, e.kinetic, e.strain, e.gravity, e.contact, e.load_work, e.impact_work, e.damping_loss,
       e.mismatch()});
  if (body_.parameters().probes.empty()) return;
  std::vector<std::string> columns{"time [s]"};
  values = {time};
  for (const auto& [name, probe] : body_.parameters().probes) {
    for (const char* axis : {" x [m]", " y [m]", " z [m]"}) columns.push_back(name + axis);
    const Vec3 u = motion.displacement(now, probe.point - body_.body().reference());
    values.insert(values.end(), u.data(), u.data() + 3);
  }
  row(probes_, "probes.csv", columns, values);
}

}  // namespace couplet::plate
