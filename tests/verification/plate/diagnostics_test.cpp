// SPDX-License-Identifier: Apache-2.0
// What bending modes cannot answer is said, and not answered wrongly: each guard is shown to fire and not to fire.
#include "common/config/load.hpp"
#include "common/modes/modal_model.hpp"
#include "plate_modal/model/build_model.hpp"
#include "plate_modal/structure.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::diagnostics_test {
using namespace mesh;

using namespace test;

/// A square plate of 1 m, its edges free but for those named.
Parameters plate_held(const std::map<std::string, Support>& held = {}) {
  Parameters p;
  p.material = {2700, 70e9, 0.33};
  p.thickness = 0.005;
  p.number = 6;
  for (const char* patch : {"xmin", "xmax", "ymin", "ymax"}) p.boundaries[patch];
  for (const auto& [patch, support] : held) p.boundaries[patch].support = support;
  return p;
}

struct Found : diagnostics::Finding {
  bool sound() const { return severity == base::Severity::note; }
};

/// Finding about this effect at the end of a run.
Found find(const std::string& id, const Parameters& p, int steps, double dt, const RawMesh& raw = square(6)) {
  Structure plate(p, PlateContext{}, &raw);
  return {support::observe(plate, steps, dt).finding(id)};
}

std::string message_of(auto&& act) {
  return support::error_of([&] { act(); });
}

TEST(PlateGuards, a_plate_on_a_hinge_may_fall_but_not_turn_far) {
  Parameters p = plate_held({{"xmin", Support::simply_supported}});
  p.gravity = {0, 0, -9.81};
  // Its rotation phi is 3 g / (2 L) t^2 / 2; along the tangent it stretches to sqrt(1 + phi^2).
  const Found little = find("large-rotation", p, 10, 0.01);
  EXPECT_NEAR(little.number, std::hypot(1, 0.75 * 9.81 * 0.01) - 1, 2e-4);
  EXPECT_TRUE(little.sound());
  const Found far = find("large-rotation", p, 10, 0.05);
  EXPECT_NEAR(far.number, std::hypot(1, 0.75 * 9.81 * 0.25) - 1, 0.05) << "more than a right angle";
  EXPECT_EQ(far.severity, base::Severity::wrong);
  // A full turn is none of no rotation.
  EXPECT_EQ(find("large-rotation", p, 10, 0.0924).severity, base::Severity::wrong);
  // A free plate that falls does not turn.
  p.boundaries["xmin"].support = Support::free;
  EXPECT_LT(find("large-rotation", p, 10, 0.05).number, 1e-6);
}

/// A clamped plate that a load in time presses onto a seat.
Parameters pressed_onto_a_seat() {
  const Support c = Support::clamped;
  Parameters p = plate_held({{"xmin", c}, {"xmax", c}, {"ymin", c}, {"ymax", c}});
  p.load.emplace().upper.emplace().text = "2000 * (1 + x) * sin(2 * pi * 20 * t)^2";
  p.contact.emplace().height.text = "-0.0026";
  p.contact->stiffness = 1e6;
  return p;
}

TEST(PlateGuards, a_resumed_run_ends_with_the_findings_of_the_unbroken_one) {
  const RawMesh raw = square(6);
  Structure one(pressed_onto_a_seat(), PlateContext{}, &raw),
      two(pressed_onto_a_seat(), PlateContext{}, &raw), three(pressed_onto_a_seat(), PlateContext{}, &raw);
  const auto whole = support::observe(one, 200, 1e-3);
  support::ObservedRun first(two), resumed(three);
  first.advance(123, 1e-3, false);
  resumed.resume(first);
  resumed.advance(77, 1e-3);
  const auto &expected = whole.diagnostics().findings(), &found = resumed.diagnostics().findings();
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].id, expected[i].id);
    EXPECT_EQ(found[i].number, expected[i].number) << found[i].id;
    EXPECT_EQ(found[i].sentence, expected[i].sentence);
  }
  EXPECT_EQ(resumed.sentences(), whole.sentences());
  EXPECT_EQ(resumed.diagnostics().errors().text(), whole.diagnostics().errors().text());
}

// The limits up to which something neglected is justified, or something that the scene has is adequate.
TEST(PlateGuards, limits_are_those_of_the_documents) {
  const Parameters p = pressed_onto_a_seat();
  const RawMesh raw = square(6);
  Structure plate(p, PlateContext{}, &raw);
  const auto run = support::observe(plate, 200, 1e-3);
  for (const char* id :
       {"large-rotation", "motion-in-the-plane", "stretch-of-the-mid-surface", "shear-and-rotary-inertia"}) {
    EXPECT_EQ(run.finding(id).limit, diagnostics::share_limit()) << id;
    EXPECT_TRUE(run.finding(id).effect.ends_with("neglected")) << id;
  }
  for (const auto& [id, limit] : {std::pair{"energy-growth", 0.01},
                                  {"load-within-a-face", 0.05},
                                  {"step-that-resolves-the-contact", 0.1}}) {
    EXPECT_EQ(run.finding(id).limit, limit) << id;
    EXPECT_FALSE(run.finding(id).effect.ends_with("neglected")) << id;
  }
}

TEST(PlateGuards, all_rigid_motions_are_kept_or_none) {
  const RawMesh raw = square(4);
  for (const int n : {1, 2}) {
    Parameters p = plate_held();
    p.number = n;
    const std::string text = message_of([&] { Structure(p, PlateContext{}, &raw); });
    EXPECT_NE(text.find("3 free rigid-body motions"), std::string::npos) << text;
    EXPECT_NE(text.find("Keep at least 3"), std::string::npos) << text;
  }
  Parameters p = plate_held();
  p.number = 3;
  EXPECT_NO_THROW(Structure(p, PlateContext{}, &raw));
  p = plate_held({{"xmin", Support::simply_supported}});
  p.number = 1;
  EXPECT_NO_THROW(Structure(p, PlateContext{}, &raw));
}

TEST(PlateGuards, what_moves_a_plate_in_its_plane_is_not_answered_with_nothing) {
  Parameters p = plate_held();
  p.gravity = {9.81, 0, 0};
  EXPECT_FALSE(find("motion-in-the-plane", p, 1, 0.01).sound());
  p.gravity = {0, 0, -9.81};
  EXPECT_TRUE(find("motion-in-the-plane", p, 1, 0.01).sound());
  p.initial_velocity = Vec3(0, 1, 1);
  EXPECT_NEAR(find("motion-in-the-plane", p, 1, 0.01).number, 1, 1e-12);
  // The weight along a plate that is held rests on its supports, unless there is no other.
  p = plate_held({{"xmin", Support::clamped}});
  p.gravity = {9.81, 0, 0};
  EXPECT_FALSE(find("motion-in-the-plane", p, 1, 0.01).sound());
  p.gravity = {9.81, 0, -9.81};
  EXPECT_TRUE(find("motion-in-the-plane", p, 1, 0.01).sound());
}

/// A clamped plate under a load beside one corner, static.
Parameters pressed(int modes) {
  const Support c = Support::clamped;
  Parameters p = plate_held({{"xmin", c}, {"xmax", c}, {"ymin", c}, {"ymax", c}});
  p.analysis = Parameters::Analysis::static_;
  p.number = modes;
  p.load.emplace().lower.emplace().text = "1000 * sin(2 * pi * x)";
  return p;
}

TEST(PlateGuards, a_static_deflection_is_judged_by_itself_and_not_by_its_modes) {
  // The first mode alone is even about the middle and sees nothing of the load.
  const auto few = [](const char* id) { return find(id, pressed(1), 1, 1); };
  const auto many = [](const char* id) { return find(id, pressed(20), 1, 1); };
  EXPECT_GT(few("stretch-of-the-mid-surface").number, 0.001);
  EXPECT_NEAR(few("stretch-of-the-mid-surface").number, many("stretch-of-the-mid-surface").number, 1e-9);
  EXPECT_FALSE(few("deflection-beyond-the-modes").sound());
  EXPECT_TRUE(many("deflection-beyond-the-modes").sound());
}

// A plate of 1 m that moves by kilometers, or by a hundred times its thickness between its supports.
TEST(PlateGuards, deflections_far_beyond_linear_theory_are_useless) {
  Parameters p = plate_held({{"xmin", Support::clamped}});
  p.initial_velocity = Vec3(0, 0, 1e6);
  EXPECT_EQ(find("large-rotation", p, 2, 0.01).severity, base::Severity::wrong);
  const auto stretch = [](double load) {
    Parameters between = pressed(20);
    between.load->lower->text = std::to_string(load);
    return find("stretch-of-the-mid-surface", between, 1, 1);
  };
  EXPECT_TRUE(stretch(100).sound());
  EXPECT_EQ(stretch(3e5).severity, base::Severity::wrong);
}

TEST(PlateGuards, the_energy_of_an_initial_velocity_is_kept_or_missed) {
  const Support s = Support::simply_supported;
  Parameters p = plate_held({{"xmin", s}, {"xmax", s}, {"ymin", s}, {"ymax", s}});
  p.initial_velocity = Vec3(0, 0, 1);
  p.number = 1;
  // The first mode has (8 / pi^2)^2 of the mass; a motion misses half of what its energy misses.
  const Found one = find("deflection-beyond-the-modes", p, 1, 1e-3, square(12));
  EXPECT_NEAR(one.number, 0.5 * (1 - 64 / std::pow(std::numbers::pi, 4)), 0.005);
  EXPECT_FALSE(one.sound());
  p = plate_held();
  p.initial_velocity = Vec3(0, 0, 1);
  EXPECT_LT(find("deflection-beyond-the-modes", p, 1, 1e-3).number, 1e-6);
}

TEST(PlateGuards, a_load_between_the_middles_of_the_faces_is_missed) {
  const Support c = Support::clamped;
  for (const auto analysis : {Parameters::Analysis::static_, Parameters::Analysis::dynamic}) {
    Parameters p = plate_held({{"xmin", c}, {"xmax", c}, {"ymin", c}, {"ymax", c}});
    p.analysis = analysis;
    const auto within = [&](const char* load) {
      p.load.emplace().upper.emplace().text = load;
      return find("load-within-a-face", p, 1, 1e-3);
    };
    // About a point of the mesh, nearer than the middles around it.
    EXPECT_FALSE(within("(x - 0.5)^2 + (y - 0.5)^2 < 0.05^2 ? 1000 : 0").sound());
    EXPECT_TRUE(within("1000 * (1 + x * y)").sound());
    // None at the start of the step: it is judged in the middle.
    EXPECT_FALSE(within("(x - 0.5)^2 + (y - 0.5)^2 < 0.05^2 ? 1e6 * t : 0").sound());
  }
}

TEST(PlateGuards, a_mesh_of_one_cell_across_is_no_mesh) {
  const Support s = Support::simply_supported;
  Parameters p = plate_held({{"xmin", s}, {"xmax", s}, {"ymin", s}, {"ymax", s}});
  p.analysis = Parameters::Analysis::static_;
  p.load.emplace().upper.emplace().text = "100";
  const auto gap = [&](int nx, int ny) {
    const RawMesh raw = make_box(BoxCells::triangles, {nx, ny, 1}, Vec3::Zero(), Vec3(1, 1, 0));
    Structure plate(p, PlateContext{}, &raw);
    return support::observe(plate, 1, 1.).diagnostics().errors().mesh;
  };
  EXPECT_GT(gap(40, 1), 0.15);
  EXPECT_GT(gap(40, 2), 0.12);  // the deflection is 0.16 off
  EXPECT_NEAR(gap(12, 12), 0.0042, 0.0015);
}

TEST(PlateGuards, edges_that_hold_nothing_or_twice_are_refused) {
  RawMesh raw = square(4);
  EXPECT_NO_THROW(midsurface_of(raw));
  raw.patches.push_back("mid");
  raw.boundary_points.push_row(std::array{raw.cell_points[0][0], raw.cell_points[0][1]});
  raw.boundary_patch.push_back(4);
  const std::string twice = message_of([&] { midsurface_of(raw); });
  // The first cell's edges: one on the outline, two inside or the other way round.
  bool inside = false, doubled = twice.find("two patches") != std::string::npos;
  for (int i = 0; i < 3; ++i) {
    RawMesh other = square(4);
    other.patches.push_back("mid");
    other.boundary_points.push_row(std::array{other.cell_points[0][i], other.cell_points[0][(i + 1) % 3]});
    other.boundary_patch.push_back(4);
    const std::string text = message_of([&] { midsurface_of(other); });
    EXPECT_NE(text.find("'mid'"), std::string::npos) << text;
    inside = inside || text.find("'mid' has an edge inside the mid-surface") != std::string::npos;
    doubled = doubled || text.find("belongs to two patches") != std::string::npos;
  }
  EXPECT_TRUE(inside);
  EXPECT_TRUE(doubled);
}

TEST(PlateGuards, an_edge_of_the_outline_in_no_patch_is_named_by_its_middle) {
  RawMesh raw = square(4);
  const auto edge = [&](Index e) {
    const auto ends = raw.boundary_points[e];
    const Vec3 middle = 0.5 * (raw.points[ends[0]] + raw.points[ends[1]]);
    return fmt::format("({:.6g}, {:.6g}) belongs to no patch", middle.x(), middle.y());
  };
  const std::string wanted = edge(raw.boundary_points.size() - 1);
  decltype(raw.boundary_points) kept;
  for (Index e = 0; e + 1 < raw.boundary_points.size(); ++e) kept.push_row(raw.boundary_points[e]);
  raw.boundary_points = kept;
  raw.boundary_patch.pop_back();
  const std::string text = message_of([&] { midsurface_of(raw); });
  EXPECT_NE(text.find(wanted), std::string::npos) << wanted << " / " << text;
}

TEST(PlateGuards, a_mesh_out_of_its_plane_is_refused) {
  RawMesh raw = square(4);
  // By its size, wherever it lies: about the origin, beside it, far from it.
  const Vec3 middle = 0.5 * (raw.points.front() + raw.points.back());
  for (const double aside : {0., 0.5, 1000.}) {
    for (Vec3& x : raw.points) x += Vec3(aside, aside, 0) - Vec3(middle.x(), middle.y(), 0);
    raw.points[7].z() = 1e-8;
    EXPECT_NO_THROW(midsurface_of(raw)) << aside;
    raw.points[7].z() = 1e-3;
    EXPECT_NE(message_of([&] { midsurface_of(raw); }).find("does not lie in the plane z = 0"),
              std::string::npos)
        << aside;
    for (Vec3& x : raw.points) x -= Vec3(aside, aside, 0) - Vec3(middle.x(), middle.y(), 0);
  }
}

TEST(PlateGuards, a_pressure_without_a_sound_value_names_its_key_time_and_place) {
  const RawMesh raw = square(4);
  const auto text = [&](const char* upper, Parameters::Analysis analysis = Parameters::Analysis::dynamic) {
    Parameters p = plate_held({{"xmin", Support::clamped}});
    p.analysis = analysis;
    p.load.emplace().upper.emplace().text = upper;
    return message_of([&] {
      Structure plate(p, PlateContext{}, &raw);
      plate.begin_step(
          {.time = 2, .dt = 0.01, .scheme = coupling::Scheme::standalone, .number = 0, .is_last = true});
      plate.solve({});
    });
  };
  for (const auto analysis : {Parameters::Analysis::dynamic, Parameters::Analysis::static_}) {
    const std::string huge = text("1e300*x", analysis);
    EXPECT_NE(huge.find("participants.plate.load.upper-pressure: at t = 2.0"), std::string::npos) << huge;
    EXPECT_NE(huge.find("s and ("), std::string::npos) << huge;
    EXPECT_NE(huge.find("e+2"), std::string::npos) << huge;
    EXPECT_NE(text("exp(1000*t)", analysis).find("load.upper-pressure: at t = 2.0"), std::string::npos);
    EXPECT_EQ(text("1e14*x", analysis), "");
  }
}

/// Doubts about the loads of ten steps of 0.01 s, after `told_at` of them or (-1) at the end of the run.
std::vector<std::string> doubts(const Parameters& p, int told_at, const std::filesystem::path& folder = {}) {
  const RawMesh raw = square(4);
  PlateContext context;
  context.case_folder = folder;
  Structure plate(p, context, p.modes_file ? nullptr : &raw);
  support::ObservedRun run(plate);
  run.advance(told_at < 0 ? 10 : told_at, 0.01, told_at < 0);
  std::vector<std::string> ids = run.doubts();
  std::erase_if(ids, [](const std::string& id) { return id != "given-without-effect"; });
  return ids;
}

TEST(PlateGuards, a_load_without_a_part_in_any_mode_is_told) {
  for (const auto analysis : {Parameters::Analysis::dynamic, Parameters::Analysis::static_}) {
    Parameters p = plate_held({{"xmin", Support::clamped}});
    p.analysis = analysis;
    p.load.emplace().upper.emplace().text = "1 + x";
    EXPECT_EQ(doubts(p, -1), std::vector<std::string>{});
    EXPECT_EQ(doubts(p, 4), std::vector<std::string>{});
    p.load->lower = p.load->upper;  // they cancel
    EXPECT_EQ(doubts(p, 4), std::vector<std::string>{});
    EXPECT_EQ(doubts(p, -1), std::vector<std::string>{"given-without-effect"});
  }
  // A plate that stands: by a file of modes its rims look up, and the bending does not move them so.
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("couplet-stands-{}", ::getpid());
  std::filesystem::create_directories(folder);
  Parameters stands = plate_held({{"xmin", Support::clamped}});
  stands.placement.x = Vec3(0, 1, 0);
  stands.placement.y = Vec3(0, 0, 1);
  const RawMesh raw = square(4);
  modes::write_modes(folder / "stands.h5", build_model(stands, PlateContext{}, &raw).model, "");
  Parameters p;
  p.modes_file = "stands.h5";
  p.load.emplace().upper.emplace().text = "1";
  p.output.fields = false;
  for (const auto analysis : {Parameters::Analysis::dynamic, Parameters::Analysis::static_}) {
    p.analysis = analysis;
    EXPECT_EQ(doubts(p, -1, folder), std::vector<std::string>{"given-without-effect"});
  }
  std::filesystem::remove_all(folder);
}

TEST(PlateGuards, a_direction_may_have_any_length) {
  const RawMesh raw = square(4);
  const auto force = [&](double length) {
    Parameters p = plate_held({{"xmin", Support::clamped}});
    p.placement.x *= 3 * length;
    p.placement.y *= length;
    p.contact.emplace().height.text = "-0.002";
    p.contact->direction = {0, 0, length};
    p.contact->starts_inside = true;
    Structure plate(p, PlateContext{}, &raw);
    Contact::ContactResult seat;
    plate.contact()->find(plate.state().q, seat);
    return seat.total;
  };
  EXPECT_GT(force(1), 0);
  EXPECT_DOUBLE_EQ(force(0.1), force(1));
  EXPECT_DOUBLE_EQ(force(1e-200), force(1));
  EXPECT_DOUBLE_EQ(force(1e200), force(1));
}

TEST(PlateGuards, axes_are_at_right_angles_however_short_they_are) {
  const auto messages = [](const std::string& x, const std::string& y) {
    Parameters p;
    const auto document = config::Document::parse(
        "mesh: a.geo\nthickness: 1 cm\nmaterial: {density: 1, youngs-modulus: 1, poissons-ratio: 0}\nplacement: {x-axis: " +
        x + ", y-axis: " + y + "}\n");
    return config::load(document, "", [&](config::Section& s) { declare(s, p); });
  };
  EXPECT_THAT(messages("[0, 1e-200, 0]", "[0, 0, 1e200]"), testing::IsEmpty());
  for (const char* y : {"[0, 1e-200, 1e-203]", "[0, 0, 0]"})
    EXPECT_THAT(messages("[0, 1e-200, 0]", y),
                testing::ElementsAre(testing::HasSubstr("must be perpendicular")));
}

TEST(PlateGuards, a_probe_stands_on_the_surface_or_near_it) {
  const RawMesh raw = square(4);
  const auto text = [&](double z) {
    Parameters p = plate_held({{"xmin", Support::clamped}});
    p.probes["tip"].point = Vec3(1, 0.5, z);
    return message_of([&] { Structure(p, PlateContext{}, &raw); });
  };
  EXPECT_EQ(text(0.0025), "");
  EXPECT_EQ(text(0), "");
  EXPECT_NE(text(0.03).find("probes.tip: (1, 0.5, 0.03) is 0.0275 m away"), std::string::npos) << text(0.03);
}

}  // namespace couplet::plate::diagnostics_test
