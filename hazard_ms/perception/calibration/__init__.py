"""How a detector errs in pictures that it was not trained on, and whether what agents believe by that is so."""
