"""Motions with an attitude: true orientation, rates and acceleration of a sensor that tilts."""
