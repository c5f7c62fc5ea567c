"""Random numbers inside kernels: the same as those of hazard_ms.chance.Chance, bit for bit, so far as they are uniform."""

from __future__ import annotations

import zlib

import warp as wp

from hazard_ms.launching import OPTIONS

wp.set_module_options(OPTIONS)

_FIRST, _SECOND = wp.constant(wp.uint32(0x7FEB352D)), wp.constant(wp.uint32(0x846CA68B))  # see hazard_ms.chance
TURN = wp.constant(6.2831853071795864)  # [rad]


def word(stream: str) -> int:
    """The name of a stream as kernels take it."""
    return zlib.crc32(stream.encode())


@wp.func
def mix(x: wp.uint32) -> wp.uint32:
    """As hazard_ms.chance."""
    y = (x ^ (x >> wp.uint32(16))) * _FIRST
    y = (y ^ (y >> wp.uint32(15))) * _SECOND
    return y ^ (y >> wp.uint32(16))


@wp.func
def key_of(seed: wp.int64, frame: wp.int64, stream: wp.uint32) -> wp.uint32:
    """What all draws of a stream have in common in a frame of an episode."""
    key = mix(wp.uint32(seed) ^ stream)
    key = mix(key ^ wp.uint32(seed >> wp.int64(32)))
    return mix(key ^ wp.uint32(frame))


@wp.func
def uniform(key: wp.uint32, index: int) -> float:
    """The number `index` of a draw, in (0, 1)."""
    bits = mix(key ^ mix(wp.uint32(index + 1)))
    return (float(bits >> wp.uint32(9)) + 0.5) / 8388608.0


@wp.func
def normal_pair(key: wp.uint32, index: int) -> wp.vec2:
    """The pair `index` of independent standard normal numbers: both halves of Box and Muller's transform."""
    length = wp.sqrt(-2.0 * wp.log(uniform(key, 2 * index)))
    angle = TURN * uniform(key, 2 * index + 1)
    return wp.vec2(length * wp.cos(angle), length * wp.sin(angle))
