"""File formats, one module each, that open a file as tables of columns (`table`, `registry`)."""
