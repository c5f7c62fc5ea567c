"""Which of the candidates for a scene of `test` or `held_out` is the scene, as results/scenes.py has chosen them."""

CHOSEN: dict[str, int] = {}
