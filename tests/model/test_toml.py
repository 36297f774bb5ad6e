import math
import tomllib

import pytest
from attrs import evolve
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from crashkit.errors import ContractError, CrashkitError
from crashkit.model import Body, InstrumentErrors, Joint, Model, Parameter
from crashkit.model.toml import model_to_toml, read_model, write_model
from crashkit.protocols import Observer, ParameterSpec
from crashkit.testing.strategies import models


class TestReading:
    def test_a_small_model(self, read, text):
        stiffness = Parameter(1.1e6, 1.0, math.inf)
        omitted = {
            "unloading_stiffness": Parameter(0.0, 1.0, math.inf, fixed=True),
            "tension": Parameter(0.0, 0.0, 1.0, fixed=True),
            "preload": Parameter(5.0, fixed=True),
        }
        assert read(text) == Model(
            name="sled",
            axes=("x",),
            bodies=(
                Body("barrier", (0.0,), (0.0,), fixed=True),
                Body("engine", (-0.55,), (15.6,), Parameter(280.0, fixed=True)),
            ),
            joints=(Joint("front", ("barrier", "engine"), "linear", {"stiffness": stiffness, **omitted}),),
        )

    @pytest.mark.parametrize(
        ("line", "expected"),
        [
            ("unloading_stiffness = 4e6", Parameter(4e6, 1.0, math.inf)),
            ("unloading_stiffness = 0", Parameter(0.0, 1.0, math.inf, fixed=True)),
            ("unloading_stiffness = { value = 4e6 }", Parameter(4e6, 1.0, math.inf)),
            ("unloading_stiffness = { value = 4e6, lower = 1e6 }", Parameter(4e6, 1e6, math.inf)),
            ("unloading_stiffness = { value = 4e6, upper = 5e6, fixed = true }", Parameter(4e6, 1.0, 5e6, fixed=True)),
            ("unloading_stiffness = { value = 4e6, fixed = false }", Parameter(4e6, 1.0, math.inf)),
            ("tension = true", Parameter(1.0, 0.0, 1.0, fixed=True)),
            ("tension = false", Parameter(0.0, 0.0, 1.0, fixed=True)),
            ("tension = 1", Parameter(1.0, 0.0, 1.0, fixed=True)),
            ("preload = 7", Parameter(7.0)),
        ],
    )
    def test_what_a_value_means(self, read, text, line, expected):
        assert read(f"{text}{line}\n").joint("front").parameters[line.split()[0]] == expected

    def test_lists_of_numbers_and_tables(self, read, text):
        text = text.replace('"linear"', '"curve"').replace(
            "stiffness = 1.1e6", "deformation = [0, 0.2]\nforce = [0.0, { value = 3e4, upper = 4e4 }]"
        )
        assert read(text).joint("front").parameters == {
            "deformation": (Parameter(0.0, 0.0, math.inf, True), Parameter(0.2, 0.0, math.inf, True)),
            "force": (Parameter(0.0, fixed=True), Parameter(3e4, upper=4e4)),
        }

    def test_factors_points_and_free_length(self, read, text):
        text = text.replace(
            'law = "linear"', 'law = "linear"\nfactors = ["power"]\npoints = [[0.1], [0]]\nfree_length = { value = 0.4 }'
        )
        joint = read(f"{text}amplitude = 0.1\nexponent = 0.3\n").joint("front")
        assert (joint.factors, joint.points, joint.free_length) == (("power",), ((0.1,), (0.0,)), Parameter(0.4))
        assert joint.parameters["exponent"] == Parameter(0.3, 0.05, 2.0)

    def test_a_free_mass_stays_above_zero(self, read, text):
        for table in ("{ value = 280, upper = 300 }", "{ value = 280, lower = -1, upper = 300 }"):
            mass = read(text.replace("mass = 280", f"mass = {table}")).body("engine").mass
            assert mass == Parameter(280.0, 0.0, 300.0)

    def test_instrument_errors(self, read, text):
        errors = '[[instrument]]\ngroup = "film"\n[instrument.parameters]\nclock_offset = { value = 0, upper = 0.01 }\n'
        sensor = '[[instrument]]\ngroup = "acc"\nsensor = "a1"\nparameters = { gain = 1.02 }\n'
        assert read(text + errors + sensor).instruments == (
            InstrumentErrors("film", "", {"clock_offset": Parameter(0.0, upper=0.01)}),
            InstrumentErrors("acc", "a1", {"gain": Parameter(1.02, fixed=True)}),
        )

    def test_a_load_and_its_carrier(self, read, text):
        load = '[[body]]\nname = "load"\nmass = 30\nposition = [-0.55]\ncarrier = "engine"\n'
        assert read(text + load).body("load") == Body("load", (-0.55,), (0.0,), Parameter(30.0, fixed=True), carrier="engine")

    def test_sample_models(self, cases):
        spring_laws = pytest.importorskip("crashkit_spring_laws", reason="the spring laws are not installed").SPRING_LAWS
        laws = {law.name: law for law in spring_laws}
        for path in sorted(cases.glob("*/model.toml")):
            model = read_model(path, laws)
            assert [body.name for body in model.bodies] == ["barrier", "powertrain", "body"]
            assert len(model.free_parameters()) == 15


class TestWriting:
    def test_is_as_a_person_would_write_it(self, read, text, laws):
        joint = read(text).joint("front")
        changed = {
            "stiffness": Parameter(1.1e6, 1e6, 2e6),
            "tension": Parameter(1.0, 0.0, 1.0, fixed=True),
            "unloading_stiffness": Parameter(4e6, 1.0, math.inf),
            "preload": Parameter(5.0, fixed=True),
        }
        model = evolve(
            read(text),
            joints=(evolve(joint, parameters=changed, points=((0.0,), (0.1,)), free_length=Parameter(0.5, fixed=True)),),
            instruments=(InstrumentErrors("film", "m1", {"gain": Parameter(0.93)}),),
        )
        assert model_to_toml(model, laws) == (
            'schema = "crashkit-model/1"\n'
            'name = "sled"\n'
            'axes = ["x"]\n'
            "\n"
            "[[body]]\n"
            'name = "barrier"\n'
            "fixed = true\n"
            "position = [0.0]\n"
            "\n"
            "[[body]]\n"
            'name = "engine"\n'
            "mass = 280.0\n"
            "position = [-0.55]\n"
            "velocity = [15.6]\n"
            "\n"
            "[[joint]]\n"
            'name = "front"\n'
            'bodies = ["barrier", "engine"]\n'
            "points = [[0.0], [0.1]]\n"
            "free_length = 0.5\n"
            'law = "linear"\n'
            "[joint.parameters]\n"
            "stiffness = { value = 1100000.0, lower = 1000000.0, upper = 2000000.0 }  # N m-1\n"
            "tension = true\n"
            "unloading_stiffness = 4000000.0  # N m-1\n"
            "\n"
            "[[instrument]]\n"
            'group = "film"\n'
            'sensor = "m1"\n'
            "[instrument.parameters]\n"
            "gain = { value = 0.93 }\n"
        )

    @settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
    @given(st.data())
    def test_any_model_written_and_read_is_the_same(self, tmp_path_factory, laws, data):
        model = data.draw(models(laws))
        path = tmp_path_factory.mktemp("model") / "model.toml"
        write_model(model, path, laws)
        assert read_model(path, laws) == model

    @settings(deadline=None)
    @given(value=st.floats(1.0, 1e300), name=st.text(st.characters(exclude_categories=["Cs"]), min_size=1))
    @example(value=0.1 + 0.2 + 1e6, name='say "front"\\\n\x7f\t')
    def test_any_number_and_text_come_back_exactly(self, tmp_path_factory, laws, text, value, name):
        path = tmp_path_factory.mktemp("model") / "model.toml"
        path.write_text(text, encoding="utf-8")
        model = read_model(path, laws)
        model = evolve(model.with_values({"joint.front.stiffness": value}), name=name)
        write_model(model, path, laws)
        assert read_model(path, laws) == model

    def test_the_shipped_laws(self, tmp_path):
        spring_laws = pytest.importorskip("crashkit_spring_laws", reason="the spring laws are not installed").SPRING_LAWS
        laws = {law.name: law for law in spring_laws}
        line = (Parameter(0.1, 0.0, math.inf, fixed=True), Parameter(0.2, 0.0, math.inf, fixed=True))
        parameters = {"deformation": line, "force": (Parameter(1e5), Parameter(2e5))}
        joint = Joint("front", ("barrier", "engine"), "piecewise_affine", parameters)
        engine = Body("engine", (-0.5,), (10.0,), Parameter(280.0, fixed=True))
        barrier = Body("barrier", (0.0,), (0.0,), fixed=True)
        write_model(Model("sled", ("x",), (barrier, engine), (joint,)), tmp_path / "a.toml", laws)
        model = read_model(tmp_path / "a.toml", laws)
        assert parameters.items() <= model.joint("front").parameters.items()
        write_model(model, tmp_path / "b.toml", laws)
        assert read_model(tmp_path / "b.toml", laws) == model

    def test_a_model_that_cannot_be_simulated_is_not_written(self, tmp_path, read, text, laws):
        model = read(text).at({"body.engine.mass": -1.0})
        with pytest.raises(ContractError, match=r'new.toml: body "engine"/mass: expected a mass above 0, found -1.0$'):
            write_model(model, tmp_path / "new.toml", laws)
        assert not (tmp_path / "new.toml").exists()

    def test_a_value_on_its_bound_may_carry_a_rounding_error(self, tmp_path, read, text, laws):
        model = read(text)
        model = model.with_parameters({"joint.front.stiffness": Parameter(math.nextafter(3e5, 4e5), 1.0, 3e5)})
        write_model(model, tmp_path / "new.toml", laws)
        assert read_model(tmp_path / "new.toml", laws) == model


class TestUnreadable:
    def test_no_toml(self, faults, text):
        assert faults(text.replace("fixed = true", "fixed true")) == [
            "expected TOML, found a fault in it: expected '=' after a key in a key/value pair (at line 7, column 7)"
        ]

    def test_the_wrong_encoding(self, tmp_path, laws):
        (tmp_path / "model.toml").write_bytes(b'name = "\xff"')
        with pytest.raises(CrashkitError, match=r"model.toml: expected a model file \(TOML\), found one that is no text"):
            read_model(tmp_path / "model.toml", laws)

    def test_no_such_file(self, tmp_path, laws):
        with pytest.raises(CrashkitError, match=r"none.toml: expected a model file, found no such file or directory$"):
            read_model(tmp_path / "none.toml", laws)

    def test_a_folder(self, tmp_path, laws):
        with pytest.raises(CrashkitError, match=r": expected a model file, found (is a directory|permission denied)$"):
            read_model(tmp_path, laws)


class TestFaults:
    @pytest.mark.parametrize(
        ("old", "new", "expected"),
        [
            ("crashkit-model/1", "crashkit-model/2", 'schema: expected "crashkit-model/1", found "crashkit-model/2"'),
            ('schema = "crashkit-model/1"\n', "", 'schema: expected "crashkit-model/1", found none'),
            ('axes = ["x"]', 'axes = "x"', 'axes: expected a list of text such as ["x"], found "x"'),
            ('axes = ["x"]', 'axis = ["x"]', 'axes: expected a list of text such as ["x"], found none'),
            ("mass = 280", "mass = -3", 'body "engine"/mass: expected a mass above 0, found -3.0'),
            ("mass = 280", "", 'body "engine"/mass: expected a mass in kg, found none'),
            ("mass = 280", "mass = nan", 'body "engine"/mass: expected a finite number, found nan'),
            (
                "mass = 280",
                'mass = "280"',
                'body "engine"/mass: expected a number, or a table of "value", "lower", "upper", "fixed", found "280"',
            ),
            (
                "mass = 280",
                "mas = 280\nmass = 280",
                'body "engine": expected one of the keys, found "mas" (did you mean "mass"?)',
            ),
            (
                "mass = 280",
                "colour = 1\nmass = 280",
                'body "engine": expected one of the keys ("name", "fixed", "mass", "inertia", "position", "orientation", '
                '"velocity", "angular_velocity", "carrier", "motion", "force"), found "colour"',
            ),
            ("position = [-0.55]", "", 'body "engine"/position: expected a list of numbers, found none'),
            (
                "position = [-0.55]",
                "position = [-0.55, 0]",
                'body "engine"/position: expected one number for each of 1 axes, found 2 numbers',
            ),
            ("position = [-0.55]", "position = [inf]", 'body "engine"/position: expected finite numbers, found inf'),
            ("position = [-0.55]", "position = [true]", 'body "engine"/position: expected a list of numbers, found [true]'),
            ("fixed = true", "fixed = 1", 'body "barrier"/fixed: expected true or false, found 1'),
            (
                "fixed = true",
                "fixed = true\nvelocity = [1]",
                'body "barrier"/velocity: expected no velocity for a fixed body, found 1.0',
            ),
            (
                'name = "engine"',
                'name = "engine"\ncarrier = "engine"',
                'body "engine"/carrier: expected one of "barrier", found "engine"',
            ),
            ('name = "engine"', "", "body[1]/name: expected text, found none"),
            ('name = "engine"', 'name = ""', "body[1]/name: expected a name, found none"),
            (
                '["barrier", "engine"]',
                '["barrier", "engin"]',
                'joint "front"/bodies: expected one of "barrier", "engine", found "engin"',
            ),
            (
                '["barrier", "engine"]',
                '["engine", "engine"]',
                'joint "front"/bodies: expected two different bodies, found "engine" twice',
            ),
            (
                '["barrier", "engine"]',
                '["engine"]',
                'joint "front"/bodies: expected the names of two bodies, found ["engine"]',
            ),
            ('law = "linear"', "", 'joint "front"/law: expected text, found none'),
            (
                'law = "linear"',
                'law = "lineer"',
                'joint "front"/law: expected one of the installed laws, found "lineer" (did you mean "linear"?)',
            ),
            (
                'law = "linear"',
                'law = "rubber"',
                'joint "front"/law: expected one of the installed laws ("curve", "linear"), found "rubber"',
            ),
            (
                'law = "linear"',
                'law = "linear + curv"',
                'joint "front"/law: expected one of the installed laws, found "curv" (did you mean "curve"?)',
            ),
            (
                'law = "linear"',
                'law = "linear + curve"',
                'joint "front"/law: expected laws that can be combined like this, of the installed laws ("curve", "linear"), '
                'found "linear + curve"',
            ),
            (
                'law = "linear"',
                'law = "power"',
                'joint "front"/law: expected one of the laws with unit "N" ("curve", "linear"), found "power" with unit "1"',
            ),
            (
                'law = "linear"',
                'law = "linear"\nfactors = ["curve"]',
                'joint "front"/factors: expected one of the factors with unit "1" ("power"), found "curve" with unit "N"',
            ),
            (
                'law = "linear"',
                'law = "linear"\npoints = [[0.0], [0.0, 1.0]]',
                'joint "front"/points: expected one number for each of 1 axes, found 2 numbers',
            ),
            ("stiffness = 1.1e6", "", 'joint "front"/stiffness: expected a number in N m-1, found none'),
            ("stiffness = 1.1e6", "stiffness = 0.5", 'joint "front"/stiffness: expected a value of at least 1.0, found 0.5'),
            ("stiffness = 1.1e6", "stiffness = inf", 'joint "front"/stiffness: expected a finite number, found inf'),
            (
                "stiffness = 1.1e6",
                f"stiffness = {10**400}",
                'joint "front"/stiffness: expected a finite number, found inf',
            ),
            ("stiffness = 1.1e6", "stiffness = [2.0]", 'joint "front"/stiffness: expected a number in N m-1, found a list'),
            (
                "stiffness = 1.1e6",
                "stiffness = true",
                'joint "front"/stiffness: expected a number, or a table of "value", "lower", "upper", "fixed", found true',
            ),
            (
                "stiffness = 1.1e6",
                "stiffness = { value = 3, lower = 5, upper = 4 }",
                'joint "front"/stiffness: expected a lower bound that does not exceed the upper, found 5.0 and 4.0',
            ),
            (
                "stiffness = 1.1e6",
                "stiffness = { value = 3, lower = 1, upper = 2 }",
                'joint "front"/stiffness: expected a value from 1.0 to 2.0, found 3.0',
            ),
            (
                "stiffness = 1.1e6",
                "stiffness = { lower = 1 }",
                'joint "front"/stiffness: expected a table with "value", found one with "lower"',
            ),
            (
                "stiffness = 1.1e6",
                "stiffness = { value = 3, free = true }",
                'joint "front"/stiffness: expected one of "value", "lower", "upper", "fixed", found "free"',
            ),
            (
                "stiffness = 1.1e6",
                "stiffness = { value = 3, fixed = 1 }",
                'joint "front"/stiffness: expected fixed as true or false, found 1',
            ),
            (
                "stiffness = 1.1e6",
                'stiffness = { value = 3, upper = "high" }',
                'joint "front"/stiffness: expected upper as a number, found "high"',
            ),
            (
                "stiffness = 1.1e6",
                "stiffness = 1.1e6\nstifness = 2.0",
                'joint "front"/parameters: expected one of the parameters, found "stifness" (did you mean "stiffness"?)',
            ),
            (
                "stiffness = 1.1e6",
                "stiffness = 1.1e6\ncolour = 2.0",
                'joint "front"/parameters: expected one of the parameters ("stiffness", "unloading_stiffness", "tension", '
                '"preload"), found "colour"',
            ),
            (
                "stiffness = 1.1e6",
                "stiffness = 1.1e6\ntension = 2",
                'joint "front"/tension: expected a value from 0.0 to 1.0, found 2.0',
            ),
        ],
    )
    def test_each_is_one_line(self, faults, text, old, new, expected):
        assert old in text
        assert expected in faults(text.replace(old, new))

    @pytest.mark.parametrize(
        ("parameters", "expected"),
        [
            ("deformation = [0.1, 0.2]\nforce = 3.0", 'joint "front"/force: expected a list of numbers in N, found a number'),
            (
                "deformation = []\nforce = []",
                'joint "front"/force: expected a list of at least one number, found an empty list',
            ),
            (
                "deformation = [0.1, 0.2]\nforce = [1.0]",
                'joint "front"/parameters: expected lists of the same length, found 2 of deformation, 1 of force',
            ),
            (
                "deformation = [0.2, 0.1]\nforce = [1.0, 2.0]",
                'joint "front"/deformation: expected strictly increasing numbers, found 0.1 after 0.2',
            ),
            (
                "deformation = [0.1, -0.1]\nforce = [1.0, 2.0]",
                'joint "front"/deformation[1]: expected a value of at least 0.0, found -0.1',
            ),
        ],
    )
    def test_lists(self, faults, text, parameters, expected):
        assert expected in faults(text.replace('"linear"', '"curve"').replace("stiffness = 1.1e6", parameters))

    @pytest.mark.parametrize("axes", ["[]", '["q"]', '["y", "x"]', '["x", "x"]', '["x", "y", "z", "x"]'])
    def test_axes(self, faults, text, axes):
        found = axes.strip("[]") or "none"
        assert faults(text.replace('axes = ["x"]', f"axes = {axes}"))[0] == (
            f'axes: expected one, two or three of "x", "y", "z", in this order, found {found}'
        )

    def test_gravity(self, read, faults, text):
        assert read(text.replace('axes = ["x"]', 'axes = ["z"]\ngravity = [-9.81]')).gravity == (-9.81,)
        assert faults(text.replace('axes = ["x"]', 'axes = ["x"]\ngravity = [0.0, -9.81]')) == [
            "gravity: expected one number for each of 1 axes, found 2 numbers"
        ]

    def test_repeated_names(self, faults, text):
        body = '[[body]]\nname = "engine"\nmass = 1\nposition = [0]\n'
        instrument = '[[instrument]]\ngroup = "film"\n'
        assert faults(body.join(text.split("[[joint]]")[:1]) + body + instrument * 2) == [
            'body: expected names without repeats, found "engine" 2 times',
            'instrument: expected names without repeats, found instrument "film" 2 times',
        ]

    def test_no_free_body(self, faults, text):
        assert faults(text.replace("mass = 280", "fixed = true").replace("velocity = [15.6]", "")) == [
            "body: expected at least one body that forces move, found none"
        ]

    def test_single_brackets(self, faults, text):
        found = faults(text.split("[[body]]")[0] + '[body]\nname = "engine"\n')
        assert found == ["body: expected tables in double brackets, found a table"]

    def test_a_factor_that_shares_a_name_with_the_law(self, faults, text, laws, clashing, monkeypatch):
        monkeypatch.setitem(laws, "doubled", clashing)
        assert faults(text.replace('law = "linear"', 'law = "linear"\nfactors = ["doubled"]')) == [
            'joint "front"/factors: expected a law and factors whose parameters have different names, '
            'found "stiffness" repeated'
        ]

    def test_an_instrument_without_a_group(self, faults, text):
        assert faults(text + "[[instrument]]\nparameters = { gain = 1.0 }\n") == [
            "instrument[0]/group: expected text, found none"
        ]

    def test_an_instrument_error_that_no_observer_declares(self, read, faults, text):
        class Gauge(Observer):
            name = "gauge"
            errors = (ParameterSpec("gain", "1", "sensitivity"), ParameterSpec("bias", "N", "offset"))

        errors = '[[instrument]]\ngroup = "acc"\nsensor = "a1"\n[instrument.parameters]\ngian = 1.0\n'
        assert faults(text + errors, observers={"gauge": Gauge}) == [
            'instrument "acc" sensor "a1"/parameters: expected one of the errors that instruments have, found "gian" '
            '(did you mean "gain"?)'
        ]
        assert read(text + errors).instruments[0].parameters == {"gian": Parameter(1.0, fixed=True)}

    def test_every_fault_is_in_one_error(self, faults, text):
        text = text.replace("mass = 280", "mass = -1").replace('"engine"]', '"wheel"]').replace("stiffness", "stifness")
        assert faults(text.replace('name = "sled"\n', "")) == [
            "name: expected text, found none",
            'body "engine"/mass: expected a mass above 0, found -1.0',
            'joint "front"/bodies: expected one of "barrier", "engine", found "wheel"',
            'joint "front"/parameters: expected one of the parameters, found "stifness" (did you mean "stiffness"?)',
            'joint "front"/stiffness: expected a number in N m-1, found none',
        ]

    @settings(max_examples=200, deadline=None)
    @given(st.data())
    def test_whatever_stands_in_the_place_of_a_value_is_read_or_refused_in_lines(self, tmp_path_factory, laws, text, data):
        value = st.sampled_from(["1", "-1.5", "nan", "true", '"x"', "[]", "[1]", '["x"]', "{}", "{ value = 1 }", "1979-05-27"])
        lines = text.splitlines()
        index = data.draw(st.sampled_from([number for number, line in enumerate(lines) if "=" in line]))
        lines[index] = f"{lines[index].split('=')[0]}= {data.draw(value)}"
        path = tmp_path_factory.mktemp("model") / "model.toml"
        path.write_text("\n".join(lines), encoding="utf-8")
        tomllib.loads(path.read_text(encoding="utf-8"))
        try:
            model = read_model(path, laws)
        except ContractError as error:
            assert all(line.startswith(f"{path}: ") for line in str(error).splitlines())
        else:
            write_model(model, path, laws)
            assert read_model(path, laws) == model
