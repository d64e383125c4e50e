"""Rewards, observations, terminations, events and curricula of your own, as functions of arrays of all environments.

>>> from crossgait import terms
>>> mine = terms.Terms(rewards={"feet_air_time": terms.RewardTerm(terms.feet_air_time, weight=2.0)})
>>> env = gymnasium.make("Crossgait/JointControl-v0", terms=mine)
"""

from crossgait.terms.configuration import with_terms
from crossgait.terms.declarations import (
    CurriculumTerm,
    EventTerm,
    ObservationTerm,
    RewardTerm,
    TerminationTerm,
    Terms,
)
from crossgait.terms.functions import (
    base_height_below,
    feet_air_time,
    foot_clearance,
    illegal_contact,
    joint_pos_limits,
    joint_vel_limits,
    push_by_setting_velocity,
    reset_joints_by_offset,
    set_parameters_uniform,
    torque_limits,
    undesired_contacts,
)

__all__ = [
    "CurriculumTerm",
    "EventTerm",
    "ObservationTerm",
    "RewardTerm",
    "TerminationTerm",
    "Terms",
    "base_height_below",
    "feet_air_time",
    "foot_clearance",
    "illegal_contact",
    "joint_pos_limits",
    "joint_vel_limits",
    "push_by_setting_velocity",
    "reset_joints_by_offset",
    "set_parameters_uniform",
    "torque_limits",
    "undesired_contacts",
    "with_terms",
]
