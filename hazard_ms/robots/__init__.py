"""The robots that can play, and their contract with skills; `hazard_ms.spec.registry.robots` finds them by name."""
