"""Motion of a run: estimate the motion that drives a model from the recorded speed and path.

`estimated_motion` calls the steps in order: validation of the records (`corrected_records`),
detection of rests (`rests`), the readings and their errors (`readings`), and the fixed-interval
smoother (`smoothing`). `docs/motion.md` describes the model.
"""
