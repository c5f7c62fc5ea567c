"""Mitigations: skills with which agents act on hazards themselves; by verb: hazard_ms.spec.registry.mitigations."""
