"""The imposed motion: from a recorded speed and path to the motion that a model is driven with.

`imposed` calls the steps in their order: what of the records can be believed (`believed`), where
the shaft rests (`rests`), the readings and their errors (`readings`), and the fixed-interval
smoother (`smoothing`, `em`). `docs/motion.md` describes the model.
"""
