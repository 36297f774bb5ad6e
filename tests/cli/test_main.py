"""The frame of the command line: what each command hands on, and how errors end."""

import os
import subprocess
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import pytest

import crashkit
from crashkit.cli import main, progress
from crashkit.errors import ContractError, CrashkitError, Fault
from crashkit.registry import Failure, Plugin, Registry

HEAVY = ("numba", "numpy", "scipy", "xarray", "netCDF4", "plotly", "pluggy")


class Api:
    """Stands for `crashkit.api`: remembers the call, then answers or fails."""

    def __init__(self) -> None:
        self.calls = []
        self.answer = "the answer"
        self.error = None

    def __getattr__(self, name):
        def call(*arguments, **options):
            self.calls.append((name, *arguments))
            self.options = options
            if self.error:
                raise self.error
            return self.answer

        return call


@pytest.fixture
def api(monkeypatch) -> Api:
    stand_in = Api()
    monkeypatch.setitem(sys.modules, "crashkit.api", stand_in)
    monkeypatch.setitem(vars(crashkit), "api", stand_in)
    monkeypatch.setattr("crashkit.registry.load", lambda: Registry((), ()))
    return stand_in


MODEL, RUN_1, RUN_2, HELD_1, HELD_2, OUT = map(Path, ("m.toml", "1.nc", "2.nc", "h1.nc", "h2.nc", "out"))


@pytest.mark.parametrize(
    "line",
    [
        "diagnose m.toml 1.nc 2.nc --holdout h1.nc h2.nc --output out",
        "diagnose --holdout h1.nc h2.nc --output out m.toml 1.nc 2.nc",
        "diagnose --output out m.toml 1.nc 2.nc --holdout h1.nc --holdout h2.nc",
        "diagnose m.toml --output out 1.nc 2.nc --holdout h1.nc h2.nc",
    ],
)
def test_diagnose_takes_runs_and_runs_held_out_in_any_order(api, capsys, line):
    api.answer = SimpleNamespace(summary="consistent")
    assert main(line.split()) == 0
    assert api.calls == [("diagnose_files", MODEL, [RUN_1, RUN_2], [HELD_1, HELD_2], OUT)]
    assert api.options["seconds"] == 180.0
    written = "wrote out/index.html\nwrote out/diagnosis.json\nwrote out/curves.nc\nwrote out/augmented_model.toml\n"
    assert capsys.readouterr().out == f"consistent\n{written}"


def test_diagnose_can_be_repeated_without_runs_held_out(api):
    api.answer = SimpleNamespace(summary="consistent")
    main("diagnose m.toml 1.nc --holdout h1.nc --output out".split())
    main("diagnose m.toml 1.nc --output out".split())
    assert [call[3] for call in api.calls] == [[HELD_1], []]


def test_diagnose_takes_a_limit_for_its_questions(api, capsys):
    api.answer = SimpleNamespace(summary="consistent")
    assert main("diagnose m.toml 1.nc --time-limit inf --output out".split()) == 0
    assert api.options["seconds"] == float("inf")
    with pytest.raises(SystemExit, match="2"):
        main("diagnose m.toml 1.nc --time-limit soon --output out".split())
    assert "argument --time-limit: expected seconds above 0, found 'soon'" in capsys.readouterr().err


CALLS = {
    "simulate m.toml --duration 0.1 --output s.nc": ("simulate_file", MODEL, 0.1, Path("s.nc")),
    "import nhtsa dir --list": ("list_channels", "nhtsa", Path("dir")),
    "import nhtsa dir --output r.nc --channel 1+2=wall:cell --channel 3=car --option window=0:0.1": (
        "import_recording",
        "nhtsa",
        Path("dir"),
        Path("r.nc"),
        ["1+2=wall:cell", "3=car"],
        {"window": "0:0.1"},
    ),
    "check m.toml 1.nc": ("check_files", [MODEL, RUN_1]),
    "identify m.toml 1.nc 2.nc": ("identify_files", MODEL, [RUN_1, RUN_2], "multi_start", progress.show),
    "cross-check 1.nc --output out": ("cross_check_file", RUN_1, "film", "accelerometer", False, OUT),
    "cross-check 1.nc --film top --accelerometer sled --known-velocity --output out": (
        "cross_check_file",
        RUN_1,
        "top",
        "sled",
        True,
        OUT,
    ),
    "demo": ("run_demo", None, Path("demo"), True),
    "demo --seed 7 --output out --no-open": ("run_demo", 7, OUT, False),
}


@pytest.mark.parametrize("line", CALLS)
def test_a_command_hands_its_arguments_on_and_prints_the_answer(api, capsys, line):
    assert main(line.split()) == 0
    assert api.calls == [CALLS[line]]
    assert capsys.readouterr().out.startswith("the answer\n")


WRITTEN = {
    "cross-check 1.nc --output out": ["out/index.html", "out/cross_check.nc"],
    "identify m.toml 1.nc --output i.toml --json i.json --curves i.nc": ["i.toml", "i.json", "i.nc"],
    "identify m.toml 1.nc --curves i.nc": ["i.nc"],
    "identify m.toml 1.nc": [],
}


@pytest.mark.parametrize("line", WRITTEN)
def test_what_was_written_is_told_after_the_answer(api, capsys, line):
    assert main(line.split()) == 0
    assert capsys.readouterr().out.splitlines() == ["the answer", *(f"wrote {file}" for file in WRITTEN[line])]


CLASHES = {
    "simulate m.nc --duration 1 --output m.nc": ("m.nc", "one of the inputs"),
    "import nhtsa r.nc --output ./r.nc": ("r.nc", "one of the inputs"),
    "identify m.toml 1.nc --output m.toml": ("m.toml", "one of the inputs"),
    "identify m.toml 1.nc --curves 1.nc": ("1.nc", "one of the inputs"),
    "identify m.toml 1.nc --predict h1.nc --curves h1.nc": ("h1.nc", "one of the inputs"),
    "identify m.toml 1.nc --json i.nc --curves i.nc": ("i.nc", "another output"),
    "diagnose out/augmented_model.toml 1.nc --output out": ("out/augmented_model.toml", "one of the inputs"),
    "cross-check out/cross_check.nc --output out": ("out/cross_check.nc", "one of the inputs"),
}


@pytest.mark.parametrize("line", CLASHES)
def test_nothing_is_written_over_an_input_or_another_output(api, capsys, line):
    file, found = CLASHES[line]
    assert main(line.split()) == 2
    assert capsys.readouterr() == ("", f"crashkit: {file}: expected a file of its own for the output, found {found}\n")
    assert api.calls == []


@pytest.mark.parametrize("line", ["diagnose m.toml 1.nc --output out", "demo"])
def test_progress_goes_to_stderr(api, capsys, line):
    api.answer = SimpleNamespace(summary="")
    main(line.split())
    api.options["progress"]("run 1 of 3")
    assert capsys.readouterr().err == "run 1 of 3\n"


ERRORS = {
    "a line": (CrashkitError("no such law"), "crashkit: no such law\n", 2),
    "several faults": (
        ContractError("run.nc", [Fault("film", "m", "mm"), Fault("initial", "a group", "none")]),
        "crashkit: run.nc: film: expected m, found mm\ncrashkit: run.nc: initial: expected a group, found none\n",
        2,
    ),
    "a folder that cannot be written": (
        PermissionError(13, "Permission denied", "out/index.html"),
        "crashkit: out/index.html: Permission denied\n",
        2,
    ),
    "a disk that is full": (OSError("disk full"), "crashkit: disk full\n", 2),
    "an interruption": (KeyboardInterrupt(), "crashkit: interrupted\n", 130),
}


@pytest.mark.parametrize("error", ERRORS)
def test_an_error_that_a_user_can_mend_is_told_without_a_traceback(api, capsys, error):
    api.error, message, status = ERRORS[error]
    assert main(["check", "1.nc"]) == status
    assert capsys.readouterr() == ("", message)


def test_a_programming_error_keeps_its_traceback(api):
    api.error = ZeroDivisionError("a bug")
    with pytest.raises(ZeroDivisionError, match="a bug"):
        main(["check", "1.nc"])


USAGE = {
    "diagnose m.toml 1.nc": "the following arguments are required: --output (see `crashkit diagnose --help`)",
    "diagnose m.toml --output o": "the following arguments are required: RUN (see `crashkit diagnose --help`)",
    "simulate m.toml --duration 1 --output o.txt": (
        "argument --output: expected a file name that ends in .nc, found 'o.txt' (see `crashkit simulate --help`)"
    ),
    "identify m.toml 1.nc --output i.nc": (
        "argument --output: expected a file name that ends in .toml, found 'i.nc' (see `crashkit identify --help`)"
    ),
    "import nhtsa dir --output r": (
        "argument --output: expected a file name that ends in .nc, found 'r' (see `crashkit import --help`)"
    ),
    "demo --seed -1": "argument --seed: expected a whole number from 0 on, found '-1' (see `crashkit demo --help`)",
    "simulate m.toml --duration long --output o.nc": (
        "argument --duration: invalid float value: 'long' (see `crashkit simulate --help`)"
    ),
    "import nhtsa dir": "one of the arguments --list --output is required (see `crashkit import --help`)",
    "import nhtsa dir --output r.nc --option window": (
        "argument --option: expected KEY=VALUE, found 'window' (see `crashkit import --help`)"
    ),
    "check": "the following arguments are required: FILE (see `crashkit check --help`)",
    "": "the following arguments are required: COMMAND (see `crashkit --help`)",
}


@pytest.mark.parametrize("line", USAGE)
def test_a_usage_error_is_one_line(capsys, line):
    with pytest.raises(SystemExit, match="^2$"):
        main(line.split())
    assert capsys.readouterr() == ("", f"crashkit: {USAGE[line]}\n")


def test_plugins_lists_what_is_installed_and_what_failed(monkeypatch, capsys):
    installed = (
        Plugin("spring law", "linear", "acme-laws", "1.0", object),
        Plugin("observer", "film", "acme-film", "12.3", object),
    )
    registry = Registry(installed, (Failure("bad", "0.9", "bad cannot be imported: ImportError: no"),))
    monkeypatch.setattr("crashkit.registry.load", lambda: registry)
    assert main(["plugins"]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines() == [
        "kind        name    distribution  version",
        "observer    film    acme-film     12.3",
        "spring law  linear  acme-laws     1.0",
        "",
        "failed to load:",
        "  bad 0.9: bad cannot be imported: ImportError: no",
    ]
    assert err == ""


def test_any_other_command_warns_of_plugins_that_failed(api, monkeypatch, capsys):
    monkeypatch.setattr("crashkit.registry.load", lambda: Registry((), (Failure("bad", "0.9", "why"),)))
    assert main(["check", "1.nc"]) == 0
    assert capsys.readouterr() == ("the answer\n", "crashkit: 1 plugin failed to load: run `crashkit plugins`\n")


def test_help_imports_nothing_heavy():
    code = f"""
import sys
from crashkit.cli import parser
parser().format_help()
print([name for name in {HEAVY!r} if name in sys.modules])
"""
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout == "[]\n"


def test_the_module_runs_as_the_command():
    answer = subprocess.run([sys.executable, "-m", "crashkit", "--version"], capture_output=True, text=True, check=True)
    assert answer.stdout.startswith("crashkit ")


def test_a_warning_is_a_line_on_stderr(api, monkeypatch, capsys):
    def check_files(files):
        warnings.warn("sensor 7: left out", stacklevel=2)
        return "checked"

    monkeypatch.setattr(crashkit.api, "check_files", check_files, raising=False)
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        assert main(["check", "1.nc"]) == 0
    assert capsys.readouterr() == ("checked\n", "crashkit: warning: sensor 7: left out\n")


def test_a_command_leaves_threads_alone_where_the_user_has_set_them(api, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    main(["check", "1.nc"])
    assert (os.environ["OMP_NUM_THREADS"], os.environ["OPENBLAS_NUM_THREADS"]) == ("3", "1")


def test_a_reader_that_has_left_is_no_error():
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write) as closed:
        run = subprocess.run([sys.executable, "-m", "crashkit", "plugins"], stdout=closed, stderr=subprocess.PIPE, text=True)
    assert (run.returncode, run.stderr) == (141, "")
