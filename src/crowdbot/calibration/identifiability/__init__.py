"""Whether recordings identify the parameters of a fit: profiles, intervals and their plot."""

from .plot import plot_profiles
from .profile import ParameterProfile, profile_parameters

__all__ = ["ParameterProfile", "plot_profiles", "profile_parameters"]
