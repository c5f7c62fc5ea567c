"""JSON of others is read with limits, and becomes dataclasses only where every type fits."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import pytest

from hazard_ms.spec.foreign import plain


@dataclass(frozen=True)
class Inner:
    name: str
    at: tuple[float, float]


@dataclass(frozen=True)
class Outer:
    count: int
    share: Annotated[float, plain.Within(0, 2)]
    flag: bool
    inner: Annotated[tuple[Inner, ...], plain.Within(1, 3)]
    note: str | None = None
    times: dict[str, float] = field(default_factory=dict)
    rest: dict[str, Any] = field(default_factory=dict)


WHOLE: dict[str, Any] = {"count": 3, "share": 1.0, "flag": True, "inner": [{"name": "a", "at": [0, 1.5]}]}


def test_values_become_what_the_types_say() -> None:
    found = plain.made(Outer, {**WHOLE, "note": "n", "times": {"a": 1}, "rest": {"x": [1, {"y": None}]}}, "it")
    assert found == Outer(3, 1.0, True, (Inner("a", (0.0, 1.5)),), "n", {"a": 1.0}, {"x": [1, {"y": None}]})
    assert type(found.inner[0].at[0]) is int
    floats = plain.made(Outer, {**WHOLE, "share": 1}, "it", plain.Limits(as_float=True))
    assert type(floats.share) is type(floats.inner[0].at[0]) is float
    assert type(floats.count) is int


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"count": 3.0}, "it.count must be a whole number"),
        ({"count": True}, "it.count must be a whole number"),
        ({"count": 10**400}, "it.count must be a whole number from -1e\\+12 to 1e\\+12"),
        ({"share": float("nan")}, "it.share must be a number"),
        ({"share": "1"}, "it.share must be a number"),
        ({"flag": 1}, "it.flag must be a bool"),
        ({"inner": {}}, "it.inner must be a list"),
        ({"inner": [{"name": "a"}]}, r"it.inner\[0\] must have at, got name"),
        ({"inner": [{"name": "a", "at": [1]}]}, r"it.inner\[0\].at must have 2 entries, got 1"),
        ({"note": 3}, "it.note must be a str"),
        ({"note": "x" * 1_000_001}, "it.note must be a text of at most 1000000 characters"),
        ({"times": {"a": "b"}}, "it.times.a must be a number"),
        ({"rest": {"a": [10**30]}}, r"it.rest.a\[0\] must be a whole number"),
        ({"other": 1}, "key of it must be one of"),
        ({"note": "\ud800"}, r"it.note must be valid Unicode, got '\\ud800'"),
        ({"inner": []}, "it.inner must be of length 1 to 3, got"),
        ({"inner": 4 * [{"name": "a", "at": [0, 1.5]}]}, "it.inner must be of length 1 to 3, got a list of 4"),
        ({"share": -0.1}, "it.share must be a number from 0 to 2, got -0.1"),
        ({"note": "\x1b" * 1_000_001}, r"got '\\x1b\\x1b"),
    ],
)
def test_what_does_not_fit_is_refused_by_its_place(change: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words) as refusal:
        plain.made(Outer, {**WHOLE, **change}, "it")
    assert len(str(refusal.value)) < 400
    assert "\x1b" not in str(refusal.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[NaN]", "numbers must be finite, got NaN"),
        ("[1e400]", "numbers must be finite, got 1e400"),
        ("[" + "9" * 31 + "]", "at most 30 digits, got 31"),
        ('{"a": 1, "a": 2}', "keys of an object must differ, got 'a' twice"),
        ("[" * 66 + "]" * 66, "nested at most 64 deep"),
        ("[" * 100_000 + "]" * 100_000, "nested at most 64 deep"),
        ("{", "valid JSON"),
        (b"\xff\xfe", "valid JSON"),
        ("", "valid JSON"),
    ],
)
def test_text_that_is_not_plain_is_refused(text: str | bytes, words: str) -> None:
    with pytest.raises(ValueError, match=f"it must .*{words}|{words}"):
        plain.parse(text, "it")


def test_depth_is_counted_from_the_outside() -> None:
    assert plain.parse("[" * 64 + "]" * 64, "it") is not None
    with pytest.raises(ValueError, match="deep"):
        plain.parse('{"a":' * 65 + "1" + "}" * 65, "it")


MEASURE = """
import resource, sys
from hazard_ms.spec.foreign import plain
text = {text}
plain.MOST_MEMORY = 0
try:
    plain.parse(text, "it")
except ValueError as error:
    print(str(error).rpartition(" ")[2])
plain.MOST_MEMORY = 10**10
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
found = plain.parse(text, "it")
print(1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before))
"""


@pytest.mark.parametrize(
    "text",
    [
        "'[' + '[],' * 600_000 + '1]'",
        "'[' + '{},' * 600_000 + '1]'",
        "'[' + '{\"a\":1},' * 300_000 + '1]'",
        "'[' + '1.5,' * 1_000_000 + '1]'",
        "'[' + '12345,' * 1_000_000 + '1]'",
        "'[' + '\"ab\",' * 1_000_000 + '1]'",
        "'{' + ','.join(f'\"{n:07d}\":1' for n in range(500_000)) + '}'",
        "'[\"' + 'a' * 20_000_000 + chr(128512) + '\"]'",
        "('[\"' + 'a' * 20_000_000 + chr(128512) + '\"]').encode()",
        "'[\"' + 'a' * 20_000_000 + '\\\\ud83d\\\\ude00' + '\"]'",
    ],
)
def test_no_text_takes_more_memory_than_it_is_allowed(text: str) -> None:
    """What is allowed for a text is at least what its values take, measured by the peak of a process of its own."""
    code = MEASURE.replace("{text}", text)
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    allowed, taken = map(int, out)
    assert 0 <= taken < allowed + 5e6


def test_a_file_that_would_take_too_much_memory_is_refused_before_it_is_parsed(tmp_path: Path) -> None:
    path = tmp_path / "bomb.json"
    path.write_text("[" + "{}," * 6_000_000 + "{}]")
    with pytest.raises(ValueError, match=r"bomb.json must need at most 800000000 bytes of memory, got up to \d+"):
        plain.read(path, 10**9)


def test_a_file_holds_one_object(tmp_path: Path) -> None:
    (tmp_path / "a").write_text(json.dumps(WHOLE))
    (tmp_path / "b").write_text("[1]")
    assert plain.read(tmp_path / "a", 1000) == WHOLE
    with pytest.raises(ValueError, match="the thing must hold an object, got a list of 1"):
        plain.read(tmp_path / "b", 1000, "the thing")
    with pytest.raises(ValueError, match="at most 10 bytes"):
        plain.read(tmp_path / "a", 10)
