"""The agent's senses: camera, hazard image, target table and semantic map."""
