"""Every case of docs/physics.md that this code covers, with its expected number: `hazard-ms validate`."""
