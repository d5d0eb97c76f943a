"""Units of measurement: names, sizes, dimensions and conversion."""
