"""Cases of mitigation: extinguishers, and doors that are opened, shut and held; 2.7 of docs/physics.md."""
