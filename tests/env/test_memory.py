"""What Python's garbage collector need not look at."""

from __future__ import annotations

import gc
import subprocess
import sys
import weakref
from collections.abc import Iterator

import pytest

from hazard_ms.env.memory import lasting


class Node:
    """What can refer to itself."""

    itself: Node


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    yield
    gc.enable()
    gc.freeze()


def garbage() -> weakref.ref[Node]:
    """A reference to what only the collector can free."""
    node = Node()
    node.itself = node
    return weakref.ref(node)


def test_what_exists_or_is_made_within_is_no_longer_looked_at() -> None:
    old = Node()
    with lasting():
        new = Node()
        assert not gc.isenabled()
    assert gc.isenabled()
    watched = {id(each) for each in gc.get_objects()}
    assert id(old) not in watched
    assert id(new) not in watched


def test_garbage_that_exists_is_freed_first() -> None:
    gc.disable()
    gone = garbage()
    assert gone() is not None
    with lasting():
        assert gone() is None


def test_garbage_that_is_made_later_is_freed() -> None:
    with lasting():
        pass
    gone = garbage()
    gc.collect()
    assert gone() is None


def test_a_collector_that_was_off_stays_off() -> None:
    gc.disable()
    with lasting():
        pass
    assert not gc.isenabled()


def test_an_import_that_fails_leaves_the_collector_as_it_was() -> None:
    with pytest.raises(ImportError), lasting():
        new = Node()
        raise ImportError
    assert gc.isenabled()
    assert id(new) in {id(each) for each in gc.get_objects()}


def test_imported_modules_are_not_looked_at_when_a_scene_changes() -> None:
    code = "import gc, hazard_ms.env; print(len(gc.get_objects()), gc.get_freeze_count(), gc.isenabled())"
    said = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
    assert int(said[1]) > 100 * int(said[0])
    assert said[2] == "True"
