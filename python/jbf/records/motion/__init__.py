"""The imposed motion: estimate the motion that drives a model from the recorded speed and path.

`imposed` calls the steps in order: validation of the records (`believed`), detection of rests
(`rests`), the readings and their errors (`readings`), and the fixed-interval smoother (`smoothing`,
`em`). `docs/motion.md` describes the model.
"""
