"""Counterpoise: a control-design studio for stabilised, out-of-balance servo mechanisms.

    import counterpoise as cp

    project = cp.Project.load("examples/reference-rig")
    design = project.design()
    print(design.verdicts())
    run = project.simulate(duration_s=2.0, demand=0.1 * np.ones(4000))

Projects, designs and recordings are in `Project`; equations, norms, margins and syntheses with the argument order of
python-control are functions of this module.
"""

from ._native import SCHEMA, CounterpoiseError, NumericalError, ProjectError, __version__
from .controllers import write_controller
from .numerics import (
    Riccati,
    balred,
    care,
    dare,
    dlyap,
    h2norm,
    h2syn,
    hinfsyn,
    linfnorm,
    lyap,
    margin,
    margins,
    poles,
    riccati,
    zeros,
)
from .progress import ProgressBar
from .project import Finding, Project
from .results import Result, System

__all__ = [
    "SCHEMA",
    "CounterpoiseError",
    "Finding",
    "NumericalError",
    "ProgressBar",
    "Project",
    "ProjectError",
    "Result",
    "Riccati",
    "System",
    "__version__",
    "balred",
    "care",
    "dare",
    "dlyap",
    "h2norm",
    "h2syn",
    "hinfsyn",
    "linfnorm",
    "lyap",
    "margin",
    "margins",
    "poles",
    "riccati",
    "write_controller",
    "zeros",
]
