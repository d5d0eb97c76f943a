"""Methods that cut a long recording into runs, one module each; `cut` combines them."""
