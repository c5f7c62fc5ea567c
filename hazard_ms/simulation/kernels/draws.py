"""Random numbers inside kernels (Warp).

Uniform numbers are those of hazard_ms.simulation.chance.Chance, bit for bit; its normal numbers come in another order.
"""

from __future__ import annotations

import zlib

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

# Multipliers of the integer mixer `lowbias32`, see hazard_ms.simulation.chance
_FIRST, _SECOND = wp.constant(wp.uint32(0x7FEB352D)), wp.constant(wp.uint32(0x846CA68B))
_TURN = wp.constant(6.2831853071795864)  # a whole turn [rad]


def word(stream: str) -> int:
    """Convert the name of a stream to the number that kernels take."""
    return zlib.crc32(stream.encode())


@wp.func
def mix(x: wp.uint32) -> wp.uint32:
    """Mix the bits of a word, as hazard_ms.simulation.chance does."""
    y = (x ^ (x >> wp.uint32(16))) * _FIRST
    y = (y ^ (y >> wp.uint32(15))) * _SECOND
    return y ^ (y >> wp.uint32(16))


@wp.func
def key_of(seed: wp.int64, frame: wp.int64, stream: wp.uint32) -> wp.uint32:
    """The key that all draws of a stream share in one frame of an episode."""
    key = mix(wp.uint32(seed) ^ stream)
    key = mix(key ^ wp.uint32(seed >> wp.int64(32)))
    return mix(key ^ wp.uint32(frame))


@wp.func
def uniform(key: wp.uint32, index: int) -> float:
    """Number `index` of a draw, uniform in (0, 1)."""
    bits = mix(key ^ mix(wp.uint32(index + 1)))
    return (float(bits >> wp.uint32(9)) + 0.5) / 8388608.0


@wp.func
def normal_pair(key: wp.uint32, index: int) -> wp.vec2:
    """Pair `index` of independent standard normal numbers, by the Box-Muller transform."""
    length = wp.sqrt(-2.0 * wp.log(uniform(key, 2 * index)))
    angle = _TURN * uniform(key, 2 * index + 1)
    return wp.vec2(length * wp.cos(angle), length * wp.sin(angle))
