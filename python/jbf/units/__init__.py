"""Units of measurement: names, conversion factors, dimensions, parsing and conversion."""
