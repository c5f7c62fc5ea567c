"""The errors of detectors in pictures that they were not trained on, and whether what agents believe by these is so."""
