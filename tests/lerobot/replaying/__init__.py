"""A policy of LeRobot that plays the recorded actions of an exported dataset again: for stock `lerobot-eval`."""
