"""Formats, one a file: each opens a file as tables of columns (`table`); `registry` lists them."""
