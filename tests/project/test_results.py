"""Every table and picture has one maker, and from version 1.0 on none is older than the release."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from hazard_ms.cli import __main__ as cli
from results import __main__ as command
from results.commits import VERSION, Checkout, version
from results.makers import MAKERS, Maker
from results.numbers_page import PAGE, page
from tests.worlds.files.checkout import ROOT

INPUTS = {"results/head.md", "results/made.csv"}  # which people and `./run results` write
PICTURES = (".svg", ".jpg", ".png")
HOMES = Maker("homes", ("python results/homes.py",), ("results/homes.md", "results/homes.csv"), 1.0, ("homes",),
              ("results/homes.csv",))  # fmt: skip
CURVE = Maker("curve", ("cp build/curve.csv results/curve.csv",), ("results/curve.csv",))


def tracked() -> list[str]:
    """Tables and pictures of this checkout."""
    if not (ROOT / ".git").exists():
        pytest.skip("this is not a checkout")
    told = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], check=True, capture_output=True, text=True)
    return [name for name in told.stdout.split("\0") if is_result(name) and name not in INPUTS]


def is_result(name: str) -> bool:
    return (name.startswith("results/") and not name.endswith(".py")) or (
        name.startswith("docs/") and name.endswith(PICTURES)
    )


def test_every_table_and_picture_has_one_maker() -> None:
    makers = {maker.name: {str(p.relative_to(ROOT)) for p in Checkout(ROOT).files(maker)} for maker in MAKERS}
    owners = {name: [maker for maker, files in makers.items() if name in files] for name in tracked()}
    assert {name: own for name, own in owners.items() if len(own) != 1} == {}
    assert len(owners) > 100 and "results/homes.md" in owners and "docs/gallery/wind_day_head_0150_raster.jpg" in owners


def test_every_script_that_writes_results_has_a_maker() -> None:
    told = " ".join(word for maker in MAKERS for word in maker.commands).replace("results.scenes", "results/scenes.py")
    for path in (ROOT / "results").glob("[a-z]*.py"):
        if '__name__ == "__main__"' in path.read_text(encoding="utf-8"):
            assert f"results/{path.name}" in told, f"results/makers.py must name {path.name}"


@pytest.mark.parametrize("maker", MAKERS, ids=lambda maker: maker.name)
def test_commands_of_makers_exist(maker: Maker) -> None:
    for line in maker.commands:
        first, second, *_ = line.split()
        if first == "hazard-ms":
            assert second in cli.COMMANDS
        elif first == "python" and second != "-m":
            assert (ROOT / second).is_file()
        else:
            assert first == "cp" or line.startswith(("python -m tests.", "python -m results."))
    assert set(maker.rows) <= set(maker.files)


def test_the_page_of_numbers_is_of_today() -> None:
    assert (ROOT / PAGE).read_text(encoding="utf-8") == page(ROOT), "make it again: ./run results --page"


def test_nothing_is_older_than_the_release() -> None:
    """Before version 1.0 nothing is asked for."""
    if not (ROOT / ".git").exists():
        pytest.skip("this is not a checkout")
    assert Checkout(ROOT).old(MAKERS) == []


@pytest.fixture
def made_up(tmp_path: Path) -> Checkout:
    """A checkout of version 0.9 with a table and a curve that were made at its only commit."""
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    for name, text in (
        (VERSION, '__version__ = "0.9.0"\n'),
        ("results/homes.csv", "a\n"),
        ("results/curve.csv", "b\n"),
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    checkout = Checkout(tmp_path)
    commit(checkout)
    wrote(checkout, checkout.head())
    checkout.note("curve", checkout.head())
    return checkout


def commit(checkout: Checkout) -> None:
    checkout.git("add", ".")
    assert checkout.git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-q", "-m", "a change") is not None


def release(checkout: Checkout, number: str) -> str:
    (checkout.root / VERSION).write_text(f'__version__ = "{number}"\n')
    commit(checkout)
    return checkout.head()


def wrote(checkout: Checkout, at: str) -> None:
    (checkout.root / "results/homes.md").write_text(f"Written at\ncommit {at}; hazard_ms; x86_64, 2 cores.\n")


def test_a_table_of_before_the_release_is_refused(made_up: Checkout) -> None:
    both, old = (HOMES, CURVE), made_up.head()
    assert made_up.old(both) == [], "0.9 is not a release"
    new = release(made_up, "1.0.0")
    assert made_up.release() == new
    told = [f"{name}: made at {old}, before the release {new}" for name in ("homes", "curve")]
    assert made_up.old(both) == told
    assert made_up.old((replace(HOMES, kept="it is"), CURVE)) == told[1:]
    wrote(made_up, f"{new}-dirty")
    made_up.note("curve", new)
    assert made_up.old(both) == [f"homes: made at {new}-dirty, of which nobody knows the code"]
    wrote(made_up, f"{new}; x; commit {old}")
    assert made_up.old(both) == told[:1], "a part of it is old"
    wrote(made_up, new)
    assert made_up.old(both) == []
    later = release(made_up, "1.0.1")
    assert later != new == made_up.release() and made_up.old(both) == [], "a repair asks for no new numbers"
    (made_up.root / "results/homes.csv").unlink()
    assert made_up.old(both) == ["homes: results/homes.csv is missing"]
    assert made_up.old((replace(CURVE, name="other"),)) == ["other: nobody knows the commit"]
    release(made_up, "1.1.0")
    assert f"curve: made at {new}, before the release {made_up.head()}" in made_up.old(both)


def test_a_table_is_stale_when_code_has_changed_and_not_when_tables_have(made_up: Checkout) -> None:
    at = made_up.head()
    commit(made_up)
    assert made_up.head() != at and made_up.state(HOMES) == f"made at {at}"
    release(made_up, "0.9.1")
    assert made_up.state(HOMES) == f"stale: of {at}"
    assert made_up.state(replace(HOMES, files=("gone.md",))) == "missing: gone.md"
    assert version('__version__ = "2.13.4"') == (2, 13) and version(None) == (0, 0)


def test_what_is_stale_is_made_from_nothing_and_what_was_stopped_resumes(
    made_up: Checkout, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[bool, bool]] = []
    raw, rows = made_up.root / "build/homes/episode.json", made_up.root / "results/homes.csv"

    def run(words: list[str], folder: Path) -> None:
        asked.append((raw.exists(), rows.exists()))
        assert words[1:] == ["results/homes.py"] and folder == made_up.root
        raw.write_text("played")
        if len(asked) == 1:
            raise subprocess.CalledProcessError(1, words)
        rows.write_text("new\n")
        wrote(made_up, made_up.head())

    monkeypatch.setattr(command, "run", run)
    (made_up.root / ".gitignore").write_text("build\n")
    raw.parent.mkdir(parents=True)
    raw.write_text("old")
    release(made_up, "0.9.1")
    assert command.make_all(made_up, [HOMES], strict=True) == 1, "its command failed"
    assert command.make_all(made_up, [HOMES], strict=True) == 0
    assert asked == [(False, False), (True, False)], "the second try resumes"
    assert {path.name for path in made_up.root.glob("build/older/*/*")} == {"homes", "homes.csv"}
    assert made_up.state(HOMES) == f"made at {made_up.head()}" and made_up.made()["homes"] == made_up.head()
    assert command.make_all(made_up, [HOMES], strict=True) == 0 and len(asked) == 2, "nothing is made twice"


def test_what_cannot_be_made_is_told(
    made_up: Checkout, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(ValueError, match="must be one of .* got 'hoems'"):
        command.chosen(["hoems"])
    with pytest.raises(ValueError, match="must be of what is made anew, got detector"):
        command.chosen(["detector"])
    with pytest.raises(ValueError, match="checkout with git only"):
        Checkout(made_up.root / "nowhere")
    monkeypatch.delenv("HAZARD_MS_NOTHING", raising=False)
    needy = replace(HOMES, files=("gone.md",), needs="$HAZARD_MS_NOTHING")
    assert command.make_all(made_up, [needy], strict=False) == 0
    assert "left out (needs $HAZARD_MS_NOTHING)" in capsys.readouterr().out
    assert command.make_all(made_up, [needy], strict=True) == 1
    (made_up.root / VERSION).write_text("changed")
    assert command.make_all(made_up, [replace(needy, needs="")], strict=True) == 1
    assert "must be committed" in capsys.readouterr().err
