"""What a command prints, whoever wrote it, holds nothing that a terminal would act on."""

from __future__ import annotations

import io
import sys

import pytest

from hazard_ms.spec.foreign.terminal import Plain, plain, plain_output

HOSTILE = "a\x1b]0;title\x07\x1b[2J\u202egnp.exe\u2066\x9b31m\x00\ud800"
SHOWN = r"a\x1b]0;title\x07\x1b[2J\u202egnp.exe\u2066\x9b31m\x00\ud800"


def test_text_keeps_its_layout_and_nothing_else_that_is_not_shown() -> None:
    assert plain("Tür\t1\n家 – ½") == "Tür\t1\n家 – ½"
    assert plain(HOSTILE + "\r\n") == SHOWN + "\\r\n"


def test_bars_of_progress_go_back_to_the_start_of_their_line() -> None:
    for overwrites, shown in ((False, "\\r50 %"), (True, "\r50 %")):
        stream = io.StringIO()
        assert Plain(stream, overwrites).write("\r50 %") == 5
        assert stream.getvalue() == shown


def test_both_streams_are_plain_in_the_block_and_themselves_after_it(capsys: pytest.CaptureFixture[str]) -> None:
    before = sys.stdout, sys.stderr
    with plain_output():
        print(HOSTILE)
        sys.stdout.writelines([HOSTILE, "\n"])
        print(HOSTILE, file=sys.stderr)
        assert not sys.stdout.isatty()
    assert (sys.stdout, sys.stderr) == before
    assert capsys.readouterr() == (f"{SHOWN}\n" * 2, f"{SHOWN}\n")


def test_a_closed_stream_stays_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    with plain_output():
        assert sys.stdout is None
