"""Plans and simulates aerial surveys of buildings (docs/tutorials/first-steps-in-python.md).

All lengths are in metres, times in seconds, angles in radians; the world frame is x east, y north,
z up. Errors are raised as skycap.Error. numpy is imported by the first array.
"""

import warnings as _warnings

from ._skycap import (
    Camera,
    Error,
    Evaluation,
    LaserScan,
    LegCheck,
    Mesh,
    Mission,
    Planner,
    PlannerCloud,
    PlanningStep,
    PointCloud,
    Prism,
    Simulation,
    Survey,
    SurveyedView,
    View,
    __version__,
    camera,
    evaluate,
    look_at,
    model,
    models,
    plan,
    read_mesh,
    scan,
    sensors,
    verify_route,
)

__all__ = [
    "Camera",
    "Error",
    "Evaluation",
    "LaserScan",
    "LegCheck",
    "Mesh",
    "Mission",
    "Planner",
    "PlannerCloud",
    "PlanningStep",
    "PointCloud",
    "Prism",
    "Simulation",
    "Survey",
    "SurveyedView",
    "View",
    "__version__",
    "camera",
    "evaluate",
    "look_at",
    "model",
    "models",
    "plan",
    "read_mesh",
    "scan",
    "sensors",
    "verify_route",
]

# Names of version 0.1, removed with 0.3.
_FORMER_NAMES = {"KeptPoints": "PlannerCloud", "LegProof": "LegCheck", "certify": "verify_route"}


def __getattr__(name):
    if name not in _FORMER_NAMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    current = _FORMER_NAMES[name]
    _warnings.warn(f"skycap.{name} is now skycap.{current}", DeprecationWarning, stacklevel=2)
    return globals()[current]
