"""Training of detectors on captured pictures."""
