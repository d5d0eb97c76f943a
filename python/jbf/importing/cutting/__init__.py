"""Ways of making runs of one long recording, one a file; `cut` puts them together."""
