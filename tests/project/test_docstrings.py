"""Docstrings, constants and error messages of the package keep their rules, and the rules notice what breaks them."""

import pytest

from tests.project.docstring_rules import faults, package_texts

HEAD = '"""Things that burn."""\n\nimport torch\nfrom torch import Tensor\n\n'
GOOD = (
    HEAD
    + '''
LIMIT = 3.0  # most of it [m]

class Law:
    """A law of nature."""

    def force(self, depth: Tensor) -> Tensor:
        """Force on each body [N], [E, B], at `depth` [m], [E, B]. Raises ValueError below zero."""
        if depth.min() < 0:
            raise ValueError(f"depth must be at least 0, got {depth.min()}")
        return depth

class Drag(Law):
    """Drag of moving water."""

    def force(self, depth: Tensor) -> Tensor:
        if depth.max() > LIMIT:
            raise ValueError(f"depth must be at most {LIMIT}, got {depth.max()}")
        return depth

    def _hidden(self):
        raise ValueError

def share(depth: Tensor) -> Tensor:
    """The wet share of each body, [E, B]."""
    return depth
'''
)
BAD = {
    "no docstring": ("a", "def f():\n    pass"),
    "no docstring of a method": ("a", 'class A:\n    """A thing that burns."""\n    def f(self):\n        pass'),
    "leans on its name": ("a", 'def f():\n    """Of the water."""'),
    "begins with what": ("a", 'def f():\n    """What the water does."""'),
    "no capital": ("a", 'def f():\n    """the water of the room."""'),
    "no full stop": ("a", 'def f():\n    """The water of the room"""'),
    "too short": ("a", 'def f():\n    """The water."""'),
    "no shape": ("b", 'def f(x: Tensor):\n    """The depth of the water [m]."""'),
    "unit, not shape": ("b", 'def f(x: "np.ndarray"):\n    """The density of the water [kg/m^3] [1/m]."""'),
    "no unit": ("b", 'def f() -> Tensor:\n    """The depth of the water, [E, B]."""'),
    "shape, not unit": ("b", 'def f() -> Tensor:\n    """The depth of the water, [N, 3]."""'),
    "silent error": ("c", 'def f():\n    """Pour water out."""\n    if 1:\n        raise ValueError("dry")'),
    "another error": ("c", 'def f():\n    """Pour it out. Raises ValueError."""\n    raise KeyError("dry")'),
    "error made elsewhere": ("c", 'def f(make):\n    """Pour water out."""\n    raise make.error("dry")'),
    "bare constant": ("d", "LIMIT = -3.0"),
    "bare tuple": ("d", "# Of another group.\nOTHER = 1\n\nLIMITS: tuple[float, ...] = (1.0, 2 * 3.0)"),
    "old form of messages": ("e", 'MESSAGE = "x is 3; 1 is allowed"'),
}


def test_the_package_keeps_the_rules() -> None:
    assert [str(fault) for fault in faults(package_texts())] == []


def test_good_code_has_no_faults() -> None:
    assert faults({"hazard_ms/good.py": GOOD}) == []


@pytest.mark.parametrize("case", BAD)
def test_each_rule_notices_what_breaks_it(case: str) -> None:
    rule, text = BAD[case]
    assert [fault.rule for fault in faults({"hazard_ms/bad.py": HEAD + text})] == [rule]


def test_a_method_without_a_documented_base_needs_a_docstring() -> None:
    text = GOOD.replace("class Drag(Law)", "class Drag")
    assert [str(fault) for fault in faults({"good.py": text})] == [
        "good.py:21: a Drag.force: no docstring",
        "good.py:21: c Drag.force: does not say that it raises ValueError",
    ]


def test_prefixes_choose_rooms() -> None:
    texts = {"hazard_ms/env.py": HEAD + "A = 1", "hazard_ms/scenes/floor.py": HEAD + "A = 1"}
    assert [fault.path for fault in faults(texts, ("hazard_ms/scenes",))] == ["hazard_ms/scenes/floor.py"]
