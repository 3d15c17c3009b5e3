"""True motions of a device in space: hands, arms, limbs, vehicles and tables, on a grid of 1 ms.

Each motion draws its settings from a random generator and lasts some seconds.
"""

from collections.abc import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation
from six_axis_sensors import GRID_HZ, Random, TrueMotion

from gyrodrift.values.arrays import Floats


def smooth_noise(n: int, hz: float, rng: Random) -> Floats:
    """Noise (n) of standard deviation 1 up to about this frequency."""
    coarse = max(8.0, GRID_HZ / hz / 8.0)
    knots = rng.normal(size=int(n / coarse) + 40)
    rough = gaussian_filter1d(knots, GRID_HZ / hz / 4.0 / coarse)
    rough = rough / rough.std()
    fine = np.interp(np.arange(n) / coarse, np.arange(len(rough)), rough)
    return np.asarray(gaussian_filter1d(fine, coarse))


def envelope(n: int, stops: list[tuple[float, float]], ramp_s: float = 0.4) -> Floats:
    """Activity (n) of a motion: 0 from start to end of each stop (s), 1 elsewhere, smooth over a ramp."""
    active = np.ones(n)
    for begin, end in stops:
        active[max(0, int((begin - ramp_s / 2) * GRID_HZ)) : int((end + ramp_s / 2) * GRID_HZ)] = 0.0
    return np.asarray(gaussian_filter1d(active, ramp_s * GRID_HZ / 6.0, mode="nearest", truncate=3.0))


def random_stops(
    seconds: float, moving: tuple[float, float], resting: tuple[float, float], rng: Random, first_s: float
) -> list[tuple[float, float]]:
    """Stops in turn with motions of these lengths; the first one from the start."""
    stops, now = [(-1.0, first_s)], first_s
    while now < seconds:
        now += rng.uniform(*moving)
        end = now + rng.uniform(*resting)
        stops.append((now, end))
        now = end
    return stops


def from_angles(yaw_deg: Floats, pitch_deg: Floats, roll_deg: Floats) -> Rotation:
    """Attitudes of yaw, pitch and roll (n each)."""
    return Rotation.from_euler("ZYX", np.column_stack((yaw_deg, pitch_deg, roll_deg)), degrees=True)


def tilted_mount(rng: Random, most_deg: float) -> Rotation:
    """How the sensor lies in its device."""
    swing = Rotation.from_rotvec(rng.normal(size=3) * (1.0, 1.0, 0.0) * most_deg / 2.0, degrees=True)
    return swing * Rotation.from_euler("z", rng.uniform(0.0, 360.0), degrees=True)


def minimum_jerk(n: int) -> Floats:
    x = np.linspace(0.0, 1.0, n)
    return np.asarray(x**3 * (10.0 - 15.0 * x + 6.0 * x * x))


def arm(rng: Random, seconds: float) -> TrueMotion:
    """Poses with stops: the hand of a robot."""
    n, mount = int(seconds * GRID_HZ), tilted_mount(rng, 60.0)
    pose, vectors, places = mount, [], []
    where, filled = rng.uniform(-0.3, 0.3, 3), 0
    rest = int(rng.uniform(1.0, 3.0) * GRID_HZ)
    while filled < n:
        vectors.append(np.repeat(pose.as_quat()[None, :], rest, axis=0))
        places.append(np.repeat(where[None, :], rest, axis=0))
        count = int(rng.uniform(0.8, 3.0) * GRID_HZ)
        share = minimum_jerk(count)[:, None]
        axis = rng.normal(size=3) * rng.uniform(0.2, 1.0) * (0.6, 0.6, 1.0)
        step = Rotation.from_rotvec(share * axis)
        target = where + rng.uniform(-0.4, 0.4, 3)
        vectors.append((pose * step).as_quat())
        places.append(where + share * (np.clip(target, -0.8, 0.8) - where))
        pose, where = pose * step[-1], places[-1][-1]
        filled += rest + count
        rest = int(max(0.0, rng.uniform(-0.5, 2.5)) * GRID_HZ) + 1
    return TrueMotion(Rotation.from_quat(np.concatenate(vectors)[:n]), np.concatenate(places)[:n])


def hand(rng: Random, seconds: float, hz: float, angle_deg: float, reach_m: float, first_s: float) -> TrueMotion:
    """A device in a hand: smooth random rotations and positions with holds that tremble."""
    n = int(seconds * GRID_HZ)
    active = envelope(n, random_stops(seconds, (8.0, 25.0), (0.5, 4.0), rng, first_s))
    clock = np.cumsum(active) / GRID_HZ
    m = int(clock[-1] * GRID_HZ) + 2 * GRID_HZ

    def path(scale: float, frequency: float) -> Floats:
        return np.asarray(np.interp(clock * GRID_HZ, np.arange(m), smooth_noise(m, frequency, rng)) * scale)

    tremor = np.cumsum(np.ones(n) / GRID_HZ)
    trembling = np.where(tremor > first_s + 0.5, 1.0, 0.0)
    trembling = gaussian_filter1d(trembling, 100.0)
    shaking = [0.15 * trembling * smooth_noise(n, 4.0, rng) for _ in range(3)]
    yaw = path(2.5 * angle_deg, hz / 3.0) + path(0.5 * angle_deg, hz) + shaking[0]
    rotations = from_angles(yaw, path(0.6 * angle_deg, hz) + shaking[1], path(angle_deg, hz) + shaking[2])
    position = np.column_stack([path(reach_m, hz) + 0.001 * trembling * smooth_noise(n, 4.0, rng) for _ in range(3)])
    return TrueMotion(rotations * tilted_mount(rng, 30.0), position)


def hand_slow(rng: Random, seconds: float) -> TrueMotion:
    return hand(rng, seconds, rng.uniform(0.3, 0.8), rng.uniform(15.0, 40.0), 0.1, rng.uniform(1.0, 3.0))


def hand_fast(rng: Random, seconds: float) -> TrueMotion:
    return hand(rng, seconds, rng.uniform(1.0, 2.5), rng.uniform(20.0, 50.0), 0.15, rng.uniform(1.0, 3.0))


def limb(rng: Random, seconds: float) -> TrueMotion:
    """A sensor on a shank or an upper arm: swings about a joint after a rest of 0.4 to 0.6 s."""
    n = int(seconds * GRID_HZ)
    active = envelope(n, random_stops(seconds, (10.0, 30.0), (0.5, 2.0), rng, rng.uniform(0.45, 0.7)), 0.2)
    clock = np.cumsum(active) / GRID_HZ
    cadence = rng.uniform(0.7, 1.2)
    phase = 2.0 * np.pi * cadence * clock
    swing = rng.uniform(15.0, 40.0) * active * np.sin(phase) + 8.0 * active * np.sin(2.0 * phase + 1.0)
    wander = np.interp(clock * GRID_HZ, np.arange(2 * n), np.cumsum(smooth_noise(2 * n, 0.3, rng)) / GRID_HZ)
    yaw = 25.0 * wander + 8.0 * active * np.sin(phase + 0.5)
    joint = from_angles(yaw, swing, 6.0 * active * np.sin(phase + 2.0))
    lever = np.array((0.0, 0.0, -rng.uniform(0.15, 0.4)))
    bob = np.column_stack((0.0 * phase, 0.0 * phase, 0.03 * active * np.sin(2.0 * phase)))
    return TrueMotion(joint * Rotation.from_rotvec(rng.normal(size=3)), joint.apply(lever) + bob)


def stick(rng: Random, seconds: float) -> TrueMotion:
    """Quick turns of a stick with a short lever, and rests between them."""
    n = int(seconds * GRID_HZ)
    active = envelope(n, random_stops(seconds, (4.0, 12.0), (1.0, 5.0), rng, rng.uniform(1.0, 3.0)), 0.3)
    clock = np.cumsum(active) / GRID_HZ
    angles = [
        np.interp(clock * GRID_HZ, np.arange(n + GRID_HZ), smooth_noise(n + GRID_HZ, rng.uniform(0.8, 2.0), rng))
        * rng.uniform(20.0, 70.0)
        for _ in range(3)
    ]
    rotations = from_angles(2.0 * angles[0], angles[1], angles[2])
    return TrueMotion(rotations * tilted_mount(rng, 60.0), rotations.apply((rng.uniform(0.1, 0.6), 0.0, 0.0)))


def drone(rng: Random, seconds: float) -> TrueMotion:
    """A multicopter whose motors run from the start: its thrust tilts as it accelerates."""
    n = int(seconds * GRID_HZ)
    first_s = rng.uniform(5.0, 10.0)
    active = envelope(n, [(-1.0, first_s)], 5.0)
    paths = [smooth_noise(n, rng.uniform(0.08, 0.18), rng) for _ in range(3)]
    begin = int(first_s * GRID_HZ)
    position = np.column_stack(
        [active * (path - path[begin]) * size for path, size in zip(paths, (1.5, 1.5, 0.6), strict=True)]
    )
    accel = np.gradient(np.gradient(position, 1 / GRID_HZ, axis=0), 1 / GRID_HZ, axis=0)
    thrust = accel + np.array((0.0, 0.0, 9.81))
    yaw = np.cumsum(active * smooth_noise(n, 0.2, rng)) / GRID_HZ * rng.uniform(10.0, 40.0)
    yaw += active * smooth_noise(n, 2.0, rng)
    flat = Rotation.from_euler("z", yaw[:, None], degrees=True)
    along = flat.inv().apply(thrust)
    pitch = np.degrees(np.arctan2(along[:, 0], along[:, 2])) + active * smooth_noise(n, 2.0, rng)
    roll = np.degrees(np.arctan2(-along[:, 1], np.hypot(along[:, 0], along[:, 2]))) + active * smooth_noise(n, 2.0, rng)
    rotations = from_angles(yaw, pitch, roll)
    return TrueMotion(rotations * tilted_mount(rng, 4.0), position, rng.uniform(1.0, 5.0), rng.uniform(1.0, 4.0))


def car(rng: Random, seconds: float, stops: list[tuple[float, float]]) -> TrueMotion:
    """A car: speed, bends, and gentle slopes; it leans a little in bends and shakes as it drives."""
    n = int(seconds * GRID_HZ)
    active = envelope(n, stops, rng.uniform(4.0, 8.0))
    speed = active * (9.0 + 4.0 * smooth_noise(n, 0.05, rng)).clip(1.0, None)
    rate = speed * smooth_noise(n, rng.uniform(0.05, 0.2), rng) * rng.uniform(0.3, 1.2)
    yaw = np.cumsum(rate) / GRID_HZ
    shaking = speed / 9.0
    along = np.cumsum(speed) / GRID_HZ
    slope = np.interp(
        along, np.linspace(0.0, along[-1] + 1.0, 400), 1.5 * gaussian_filter1d(rng.normal(size=400), 6.0) * 4
    )
    bumps = [shaking * smooth_noise(n, 3.0, rng) for _ in range(3)]
    lean = 0.15 * np.radians(rate) * speed / 9.81 * 57.3
    rotations = from_angles(yaw, -slope + 0.2 * bumps[0], lean + 0.25 * bumps[1])
    ahead = Rotation.from_euler("z", yaw[:, None], degrees=True).apply(
        np.column_stack((speed, 0.0 * speed, 0.0 * speed))
    )
    position = np.cumsum(ahead, axis=0) / GRID_HZ
    position[:, 2] += 0.004 * bumps[2]
    return TrueMotion(rotations * tilted_mount(rng, 4.0), position)


def car_with_stops(rng: Random, seconds: float) -> TrueMotion:
    return car(rng, seconds, random_stops(seconds, (20.0, 50.0), (4.0, 15.0), rng, rng.uniform(3.0, 8.0)))


def car_without_stops(rng: Random, seconds: float) -> TrueMotion:
    return car(rng, seconds, [])


def turntable(rng: Random, seconds: float) -> TrueMotion:
    """A turntable whose axis is tilted, with constant rates and stops."""
    n = int(seconds * GRID_HZ)
    rate, now = np.zeros(n), int(rng.uniform(1.5, 4.0) * GRID_HZ)
    while now < n:
        end = now + int(rng.uniform(3.0, 15.0) * GRID_HZ)
        rate[now:end] = rng.uniform(-60.0, 60.0)
        now = end + int(max(0.0, rng.uniform(-2.0, 6.0)) * GRID_HZ)
    angle = np.cumsum(gaussian_filter1d(rate, 80.0, truncate=6.0)) / GRID_HZ
    table = Rotation.from_rotvec(rng.normal(size=3) * (0.4, 0.4, 0.0))
    turning = table * Rotation.from_euler("z", angle[:, None], degrees=True)
    return TrueMotion(turning * tilted_mount(rng, 40.0), turning.apply((rng.uniform(0.0, 0.3), 0.0, 0.0)))


def ramps(rng: Random, seconds: float) -> TrueMotion:
    """A robot on wheels that drives over ramps, turns and stops."""
    n = int(seconds * GRID_HZ)
    active = envelope(n, random_stops(seconds, (5.0, 20.0), (1.0, 6.0), rng, rng.uniform(1.0, 4.0)), 0.8)
    speed = active * rng.uniform(0.3, 1.0)
    clock = np.cumsum(active) / GRID_HZ
    yaw = np.interp(clock * GRID_HZ, np.arange(2 * n), np.cumsum(smooth_noise(2 * n, 0.3, rng)) / GRID_HZ) * 40.0
    hills = np.interp(clock * GRID_HZ, np.arange(2 * n), smooth_noise(2 * n, 0.25, rng)) * rng.uniform(4.0, 9.0)
    banks = np.interp(clock * GRID_HZ, np.arange(2 * n), smooth_noise(2 * n, 0.25, rng)) * 4.0
    rattle = [active * smooth_noise(n, 5.0, rng) for _ in range(3)]
    rotations = from_angles(yaw, hills + 0.1 * rattle[0], banks + 0.1 * rattle[1])
    ahead = rotations.apply(np.column_stack((speed, 0.0 * speed, 0.0 * speed)))
    position = np.cumsum(ahead, axis=0) / GRID_HZ
    position[:, 2] += 0.0005 * rattle[2]
    return TrueMotion(rotations * tilted_mount(rng, 10.0), position)


def boat(rng: Random, seconds: float) -> TrueMotion:
    """A boat that rolls, pitches and heaves all the time."""
    n, hz = int(seconds * GRID_HZ), rng.uniform(0.12, 0.3)
    roll, pitch = smooth_noise(n, hz, rng) * rng.uniform(2.0, 8.0), smooth_noise(n, hz, rng) * rng.uniform(1.0, 4.0)
    yaw = np.cumsum(smooth_noise(n, 0.05, rng)) / GRID_HZ * rng.uniform(0.5, 3.0) + 2.0 * smooth_noise(n, hz, rng)
    position = np.column_stack([smooth_noise(n, hz, rng) * size for size in (0.2, 0.3, 0.4)])
    return TrueMotion(from_angles(yaw, pitch, roll) * tilted_mount(rng, 10.0), position, 0.1, 0.1)


def even_turn(rng: Random, seconds: float) -> TrueMotion:
    """A level table that turns evenly from before the first sample, then stops, and goes on with moves."""
    n = int(seconds * GRID_HZ)
    rate = np.zeros(n)
    rate[: int(rng.uniform(10.0, 30.0) * GRID_HZ)] = rng.choice((-1.0, 1.0)) * rng.uniform(2.0, 8.0)
    now = int(35.0 * GRID_HZ)
    while now < n:
        end = now + int(rng.uniform(2.0, 8.0) * GRID_HZ)
        rate[now:end] = rng.uniform(-40.0, 40.0)
        now = end + int(rng.uniform(2.0, 10.0) * GRID_HZ)
    yaw = np.cumsum(gaussian_filter1d(rate, 80.0, truncate=6.0)) / GRID_HZ
    turning = Rotation.from_euler("z", yaw[:, None], degrees=True)
    return TrueMotion(turning * tilted_mount(rng, 20.0), np.zeros((n, 3)))


MOTIONS: dict[str, Callable[[Random, float], TrueMotion]] = {
    motion.__name__: motion
    for motion in (
        arm,
        hand_slow,
        hand_fast,
        limb,
        stick,
        drone,
        car_with_stops,
        car_without_stops,
        turntable,
        ramps,
        boat,
        even_turn,
    )
}
