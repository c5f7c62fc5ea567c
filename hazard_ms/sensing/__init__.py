"""What the agent senses: camera, hazard image, target table, semantic map."""
