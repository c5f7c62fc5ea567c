"""The parts that `planner` and `mcts` share: memory, forecasts, walking times, and the problem that they solve."""
