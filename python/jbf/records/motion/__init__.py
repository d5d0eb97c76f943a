"""The imposed motion: from a recorded speed and path to the motion that a model is driven with.

`imposed` is the recipe; `roughness` the noise on a signal, `rests` where the shaft stands still,
`agreement` whether speed and path tell the same, `smoothing` local polynomials through both.
"""
