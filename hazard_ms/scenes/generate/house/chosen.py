"""The numbers of the candidates that are the scenes of `test` and `held_out`, as results/scenes.py has chosen them."""

CHOSEN: dict[str, int] = {}
