"""Exporters: demonstrations in the formats that learners of other packages read."""
