# SPDX-License-Identifier: Apache-2.0
"""Wrong launches and uncaught errors: one clear message, all processes end, the exit code tells."""
from jobs import Suite, case_text, mpmd

suite = Suite(at_once=2)
text = case_text()
case = {"case.yaml": text}
right = "Start it with: couplet run case.yaml --with fluid='COMMAND ...' --with solid='COMMAND ...'"
coupler, piston, spring = "1 coupler case.yaml", "1 toy_piston case.yaml", "1 toy_spring case.yaml"

suite.scenario("all there", mpmd(coupler, "3 toy_piston case.yaml", "2 toy_spring case.yaml"), case, 0,
               ["t=1/1 s  step 10"])
suite.scenario("participant missing", mpmd(coupler, piston), case, 2,
               ["participant 'solid' (toy_spring) is missing: it was not started.", right])
suite.scenario("coupler missing", mpmd(piston, spring), case, 2,
               ["participant 'coupler' (coupler) is missing: it was not started.", right])
suite.scenario("coupler alone", mpmd(coupler), case, 2,
               ["participant 'fluid' (toy_piston) is missing", "participant 'solid' (toy_spring) is missing", right])
suite.scenario("one program of a coupled case", ["toy_spring", "case.yaml"], case, 2,
               ["participant 'fluid' (toy_piston) is missing",
                "To run 'solid' alone: toy_spring case.yaml --participant solid"])
suite.scenario("one program alone on purpose", ["toy_spring", "case.yaml", "--participant", "solid"], case, 0,
               ["t=1/1 s  step 10"])
suite.scenario("same participant twice", mpmd(coupler, piston, spring, spring), case, 2,
               ["2 programs were started as participant 'solid' (toy_spring)", right])
suite.scenario("one too many", mpmd(coupler, piston, spring, "1 toy_spring case.yaml --participant extra"), case, 2,
               ["--participant extra: case.yaml has no participant with this name.", right])
suite.scenario("wrong program", mpmd(coupler, piston, "1 toy_piston case.yaml --participant solid"), case, 2,
               ["--participant solid: this participant is run by the program 'toy_spring', but 'toy_piston' was started"])
suite.scenario("program that nobody asked for", mpmd(coupler, spring, piston),
               {"case.yaml": text.replace("toy_piston", "fluid_solver")}, 2,
               ["no participant is run by the program 'toy_piston'"])
suite.scenario("a coupler of two ranks", mpmd("2 coupler case.yaml", piston, spring), case, 0, ["t=1/1 s  step 10"])
suite.scenario("two couplers", mpmd(coupler, coupler, piston, spring), case, 2,
               ["2 programs were started as participant 'coupler' (coupler)"])
suite.scenario("different YAML files", mpmd(coupler, piston, "1 toy_spring other.yaml"),
               {"case.yaml": text, "other.yaml": case_text(solid=", vertices: 3")}, 2,
               ["'coupler' reads case.yaml and 'solid' reads other.yaml, and the contents differ."])
suite.scenario("different overrides",
               mpmd(coupler, piston, "1 toy_spring case.yaml --set participants.solid.mass=2"), case, 2,
               ["and the contents differ. All programs of a job need the same YAML file and the same --set"])
suite.scenario("restart of some only", mpmd(coupler, piston, "1 toy_spring case.yaml --restart out/checkpoints"), case,
               2, ["'coupler' starts afresh and 'solid' was given --restart out/checkpoints."])
suite.scenario("restart without a checkpoint",
               mpmd(*(p + " --restart nowhere" for p in (coupler, piston, spring))), case, 2,
               ["--restart nowhere: no complete checkpoint found."])
suite.scenario("no coupling section", mpmd(piston, spring), {"case.yaml": text.split("coupling:")[0]}, 2,
               ["case.yaml has no `coupling` section, so its participants cannot run as one job"])
suite.scenario("configuration error in one part", mpmd(coupler, piston, spring),
               {"case.yaml": text.replace("mass: 0.5 kg", "mass: 0.5 m")}, 2, ["[solid] case.yaml:"])
suite.scenario("unreadable YAML", mpmd(coupler, piston, spring), {"case.yaml": "a: [1\n"}, 2, ["case.yaml:"])
suite.scenario("role of nobody", mpmd(coupler, piston, spring),
               {"case.yaml": text.replace("structure: {participant: solid}", "structure: {participant: soild}")}, 2,
               ["coupling.structure.participant: there is no participant 'soild'. Did you mean 'solid'?"])
suite.scenario("points that do not match", mpmd(coupler, piston, spring),
               {"case.yaml": case_text(fluid=", shift: 0.01 m")}, 2,
               ["2 of 2 vertices of 'fluid' match none of the 2 vertices of 'solid'",
                "(1, 0.01, 0): the nearest is 0.01 m away"])
suite.scenario("folder of a running job",
               ["sh", "-c", "toy_spring long.yaml --participant solid > /dev/null & sleep 1; "
                "toy_spring case.yaml --participant solid; code=$?; kill $!; exit $code"],
               {"case.yaml": text, "long.yaml": case_text(end="1e7 s")}, 2,
               ["The output folder out/solid is in use by another job that is still running."])
suite.scenario("error in the set-up", mpmd(coupler, "3 toy_piston case.yaml", spring),
               {"case.yaml": case_text(fluid=", throws-at-start: true")}, 2,
               ["error: The piston was told not to start."], not_lines=["was killed"],
               once="The piston was told not to start.")
suite.scenario("exception in a step", mpmd(coupler, "2 toy_piston case.yaml", spring),
               {"case.yaml": case_text(fluid=", throws-in-step: 3")}, 1,
               ["error: The piston broke, as it was told to."], not_lines=["was killed"])
suite.scenario("a step that no halving saves", mpmd(coupler, piston, spring),
               {"case.yaml": case_text(fluid=", fails-above: 0.1 ms")}, 1,
               ["The step from t = 0 s failed, even with dt = 0.0015625 s after 6 halvings: 'fluid'"])
suite.finish()
