"""Laws of one body, written for NVIDIA Warp: functions (`wp.func`), structs, and kernels that several hazards share.

When a law is a kernel and when it is torch: a law that does many operations on each body in every physics step (water,
wind, drag, containers) is a Warp kernel with one thread per body; a law that works on whole tensors every few frames,
gathers all pairs, or runs at reset only (fire, smoke, gusts, the lee of houses, flow paths) is torch, which needs no
compiling and is easier to check. Every module of laws says on its first lines which of the two it is.

Nothing here knows World, a state or torch, except `launch`, which starts kernels on tensors.
"""
