"""HDR, restlevel and registered filters as methods, and the filter that a device runs itself.

The kernels of filters equal their `step` bit for bit. On three axes restlevel is the attitude filter. Other filters run
on the rate of the heading.
"""

from dataclasses import asdict, replace
from functools import cache

import numpy as np

from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.plain import steps_s
from gyrodrift.evaluation.attitude import AttitudeHistory, filter_history
from gyrodrift.evaluation.auxiliary import NO_AUXILIARY, Auxiliary, DeviceColumns, InertialColumns
from gyrodrift.evaluation.kernels.kernel import kernel_of
from gyrodrift.evaluation.space import axes_of, row_of
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.session.aids import RowAids
from gyrodrift.values.arrays import Floats


def filter_method(chosen: Filter, params: FilterParams | None = None, auxiliary: Auxiliary = NO_AUXILIARY) -> Method:
    """A filter as a method, with these parameters or its defaults, and with auxiliary data if given."""

    def run(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
        return kernel_of(chosen).yaw(steps_s(t_s), rate_dps, row_of(chosen.params(**params))[0], auxiliary)

    def sigma(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
        stated = kernel_of(chosen).sigma
        if stated is None:
            return np.full(len(t_s), np.nan)
        return stated(steps_s(t_s), rate_dps, row_of(chosen.params(**params))[0], auxiliary)

    return Method(
        chosen.name,
        chosen.title or chosen.name,
        run,
        asdict(chosen.params() if params is None else params),
        axes_of(chosen),
        about=chosen.about,
        counts_samples=chosen.counts_samples,
        sigma=sigma,
        with_auxiliary=lambda data: filter_method(chosen, auxiliary=data),
        with_axes=attitude_method if chosen is RESTLEVEL else None,
        color=chosen.color,
        dash=chosen.dash,
    )


def attitude_method(axes: InertialColumns, auxiliary: Auxiliary) -> Method:
    """The attitude filter as a method for these data."""
    return _stepped(filter_method(RESTLEVEL), axes, auxiliary, ())


def aided(axes: InertialColumns | None, auxiliary: Auxiliary, aids: RowAids) -> Method:
    """Restlevel with the second sources of a session as a method for these data."""
    return _stepped(AIDED, axes, auxiliary, aids)


def _stepped(method: Method, axes: InertialColumns | None, auxiliary: Auxiliary, aids: RowAids) -> Method:
    """The method run by the steps of restlevel, sample by sample."""

    @cache
    def history(times: bytes, rates: bytes, values: tuple[float, ...]) -> AttitudeHistory:
        """One run gives yaw and its sigma."""
        params = RESTLEVEL.params(*values)
        return filter_history(np.frombuffer(times), np.frombuffer(rates), axes, auxiliary, params, aids)

    def run(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
        return history(t_s.tobytes(), rate_dps.tobytes(), tuple(params.values())).yaw_deg

    def sigma(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
        return history(t_s.tobytes(), rate_dps.tobytes(), tuple(params.values())).yaw_sigma_deg

    return replace(method, run=run, sigma=sigma)


def missing_aids(_t_s: Floats, _rate_dps: Floats, _params: Params) -> Floats:
    """No yaw for a session without second sources."""
    raise ValueError("the method needs second sources")


AIDED = Method(
    "restlevel-aided",
    "restlevel with second sources",
    missing_aids,
    asdict(RESTLEVEL.params()),
    about="Restlevel at its defaults with the second sources of the recording: headings, turn rates, wheels, speed.",
    needs_aids=True,
    with_aids=aided,
    color=RESTLEVEL.color,
    dash="--",
)


def missing_yaw(_t_s: Floats, _rate_dps: Floats, _params: Params) -> Floats:
    """No yaw for a device without a filter."""
    raise ValueError("the method needs the yaw of the device's own filter")


def recorded(device: DeviceColumns) -> Method:
    """The method for the columns of a session."""
    return replace(
        ON_DEVICE,
        run=lambda _t_s, _rate_dps, _params: device.yaw_deg - device.yaw_deg[0],
        sigma=lambda _t_s, _rate_dps, _params: device.yaw_sigma_deg,
    )


ON_DEVICE = Method(
    "on-device",
    "on-device",
    missing_yaw,
    about="The filter that the device runs itself: its yaw and sigma as recorded, held where a sample has none.",
    needs_device_yaw=True,
    with_device_yaw=recorded,
    color="two",
    dash="--",
)
