"""Messages of the bridge: what is sent arrives bit by bit, and bytes of strangers are refused before they cost much."""

from __future__ import annotations

import socket
import struct
import threading
import time
import tracemalloc
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from hazard_ms.lerobot import hazard_client
from hazard_ms.lerobot.hazard_client import MOST_BYTES, MOST_JSON, packed, receive, send

Pair = tuple[socket.socket, socket.socket]


@pytest.fixture
def pair() -> Iterator[Pair]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield ours, theirs


def framed(head: bytes, body: bytes = b"") -> bytes:
    return struct.pack("!II", len(head), len(body)) + head + body


def test_what_is_sent_arrives_bit_by_bit(pair: Pair) -> None:
    arrays = [np.arange(6, dtype=kind).reshape(1, 2, 3, 1) for kind in ("u1", "i4", "i8", "f4", "f8")]
    arrays += [np.zeros((0, 3), np.float32), np.array(2.5), np.arange(9, dtype=">f8")[::-3], np.float32([np.nan, -0.0])]
    value = {"a": arrays, "b": [None, True, 2**40, 0.1 + 0.2, float("inf"), "Fährt"], "c": {"d": {}}}
    send(pair[0], packed(value))
    found = receive(pair[1], 5.0)
    assert {key: found[key] for key in "bc"} == {key: value[key] for key in "bc"}
    for got, array in zip(found["a"], arrays, strict=True):
        assert got.shape == array.shape and got.dtype == array.dtype.newbyteorder("<")
        assert got.tobytes() == array.astype(got.dtype).tobytes()
        assert got.flags.writeable and got.flags.aligned and got.flags.owndata
    send(pair[0], packed((np.float32(0.1), np.True_, np.int64(3))))
    assert receive(pair[1], 5.0) == [float(np.float32(0.1)), True, 3]


@pytest.mark.parametrize(
    ("bytes_", "message"),
    [
        (b"GET / HTTP/1.1\r\n\r\n", rf"at most {MOST_JSON} \+ {MOST_BYTES} bytes, got 1195725856 \+"),
        (struct.pack("!II", MOST_JSON + 1, 0), f"got {MOST_JSON + 1} "),
        (struct.pack("!II", 2, MOST_BYTES + 1), f"got 2 . {MOST_BYTES + 1}"),
        (framed(b"{]"), "must begin with JSON, got b'{]'"),
        (framed(b"\xff\xfe"), "must begin with JSON"),
        (framed(b"[" * 60000), "must begin with JSON"),
        (framed(b"", b"x"), "must begin with JSON, got b''"),
        (framed(b"3", b"x"), "must fill 1 bytes"),
        (framed(b'{"array": ["<f4", 2]}', b"1234"), r"at most 4 bytes.*\['<f4', 2\]"),
        (framed(b'[{"array": ["<f4", 1]}, {"array": ["|u1", 1]}]', b"1234"), "at most 0 bytes"),
        (framed(b'{"array": ["<f4", 1000000, 1000000, 1000000]}', b"1234"), "at most 4 bytes"),
        (framed(b'{"array": ["<f4", 99999999999999999999]}', b"1234"), r"must be \[dtype, \*shape\]"),
        (framed(b'{"array": ["|O", 1]}', b"12345678"), r"must be \[dtype, \*shape\].*'\|O'"),
        (framed(b'{"array": ["<f4", -1]}', b"1234"), r"must be \[dtype, \*shape\]"),
        (framed(b'{"array": ["<f4", true]}', b"1234"), r"must be \[dtype, \*shape\]"),
        (framed(b'{"array": ["<f4", 1, 1, 1, 1, 1]}', b"1234"), r"must be \[dtype, \*shape\]"),
        (framed(b'{"array": [["<f4"], 1]}', b"1234"), r"must be \[dtype, \*shape\]"),
        (framed(b'{"array": "<f4"}', b"1234"), r"must be \[dtype, \*shape\]"),
    ],
)
def test_bytes_that_are_no_message_are_refused_at_once(pair: Pair, bytes_: bytes, message: str) -> None:
    """With the value that is wrong, without waiting for what was announced, and without memory for it."""
    pair[0].sendall(bytes_)
    tracemalloc.start()
    begun = time.monotonic()
    with pytest.raises(ValueError, match=message):
        receive(pair[1], 5.0)
    assert tracemalloc.get_traced_memory()[1] < 4e6 and time.monotonic() - begun < 4.0
    tracemalloc.stop()


@pytest.mark.parametrize("kept", [0, 3, 8, 12, 45])
def test_who_leaves_within_a_message_is_noticed(pair: Pair, kept: int) -> None:
    message = packed({"a": np.zeros(9)})
    pair[0].sendall(message[:kept])
    pair[0].close()
    with pytest.raises(ConnectionError, match=r"closed the connection after \d+ of \d+ bytes"):
        receive(pair[1], 5.0)


@pytest.mark.parametrize("kept", [0, 5, 9, 45])
def test_nobody_waits_for_ever(pair: Pair, kept: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hazard_client, "MESSAGE_SECONDS", 0.2)
    pair[0].sendall(packed({"a": np.zeros(9)})[:kept])
    with pytest.raises(TimeoutError, match="must arrive in time"):
        receive(pair[1], 0.2)


def test_who_sends_a_byte_now_and_then_is_not_waited_for(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hazard_client, "MESSAGE_SECONDS", 0.5)
    stopped = threading.Event()

    def drip() -> None:
        for byte in packed({"a": np.zeros(9)}):
            if stopped.wait(0.1):
                return
            pair[0].sendall(bytes([byte]))

    thread = threading.Thread(target=drip)
    thread.start()
    with pytest.raises(TimeoutError):
        receive(pair[1], 5.0)
    stopped.set()
    thread.join()


def test_who_takes_nothing_is_not_waited_for(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hazard_client, "MESSAGE_SECONDS", 0.2)
    with pytest.raises(TimeoutError):
        send(pair[0], packed(np.zeros(2**21)))


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (object(), "plain values and arrays, got <object"),
        ({1: 2}, "keys must be strings"),
        ({"array": 2}, "keys must be strings other than 'array'"),
        (np.array([None]), "an array must be of .*, got object"),
        (np.array(["a"]), "an array must be of"),
        (np.zeros((1,) * 5), "an array must be of"),
        (np.zeros(MOST_BYTES + 1, np.uint8), f"{MOST_BYTES + 1}"),
        ("a" * MOST_JSON, f"got {MOST_JSON + 2} "),
    ],
)
def test_what_no_message_holds_is_not_sent(value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        packed(value)
