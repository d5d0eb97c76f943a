"""Parameter estimation: from a model and runs to parameters with standard errors.

Input: a `Campaign` (runs prepared once), a law and effects. Output: `Fit`, `Bootstrap`,
`TrajectoryFit`. `samples` selects the samples of the fit and their weights; `noise` is the noise
model of the instrument. `problem` encodes parameters and predicts the friction; `minimum` minimises
the sum of squares. `standard_errors` computes the uncertainty of the estimates. `identifiability`
decides which parameters are held fixed.

May import: `jbf.records`, `jbf.models`, `jbf._core`.
"""
