"""Laws of one body, written for NVIDIA Warp: functions (`wp.func`) and the kernels that hazards start. No World, no state, no torch."""
