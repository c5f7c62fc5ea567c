"""The sketch as environments of gymnasium, one rescue or many at once, as learners meet them."""
