"""Labels and ranges of all numbers that can be set: on the page, and in a file of a session."""

from floorplans.values import COORDINATE
from rssnav.explorer.antenna_choice import AZIMUTH, ELEVATION
from rssnav.explorer.ranges import Range
from rssnav.explorer.searching import MAX_STEPS
from rssnav.explorer.training import MAX_EPISODES
from rssnav.learning_parameters import QLearning

_X, _Y = ((f"{axis} [m]", COORDINATE.least, COORDINATE.most, 0.1) for axis in "xy")


def _of(whose: str, label: str, low: float, high: float, step: float) -> Range:
    return Range(f"{whose} {label}", low, high, step)


_HEIGHT = (0.01, 1000.0, 0.1)
PLACES = {
    "source_x_m": _of("Source", *_X),
    "source_y_m": _of("Source", *_Y),
    "source_z_m": Range("Source z [m]", *_HEIGHT),
    "start_x_m": _of("Start", *_X),
    "start_y_m": _of("Start", *_Y),
}
MAP_NUMBERS = {
    "cell_size_m": Range("Cell size [m]", 0.05, 1000.0, 0.25),
    "height_m": Range("Receiver height [m]", *_HEIGHT),
    "max_reflections": Range("Reflections", 0, 8, whole=True),
    "power_dbm": Range("Power [dBm]", -50.0, 60.0),
    "frequency_ghz": Range("Frequency [GHz]", 1.0, 100.0),
}
MOST_TRANSMISSIONS = 6
DIRECTIONS = {
    f"{end.lower()}_{name}_deg": _of(end, angle.label.lower(), angle.low, angle.high, angle.step)
    for end in ("Transmit", "Receive")
    for name, angle in (("azimuth", AZIMUTH), ("elevation", ELEVATION))
}
TRAINING = {
    "speed": Range("Speed [cells per step]", 1, 8, whole=True),
    "episodes": Range("Episodes", 1, MAX_EPISODES, 100, whole=True),
    "goal_rss_dbm": Range("Goal: RSS above [dBm]", -1000.0, 1000.0),
    "goal_distance_m": Range("Goal: within [m]", 0.1, 1000.0, 0.5),
    "tolerance_db": Range("Tolerance of states [dB]", 0.0, 1000.0, 0.5),
    "seed": Range("Seed", 0, 2**53 - 1, whole=True),
}
SEARCH = {
    "speed": TRAINING["speed"],
    "max_steps": Range("Seconds at most", 1, MAX_STEPS, 100, whole=True),
    "goal_rss_dbm": TRAINING["goal_rss_dbm"],
    "sigma_db": Range("Fluctuation \u03c3 [dB]", 0.0, 20.0, 0.5),
    "confirmations": Range("Readings to confirm", 1, 100, whole=True),
    "battery_kj": Range("Battery [kJ]", 0.1, 1000.0),
    "seed": TRAINING["seed"],
}
LEARNING = {
    "gamma": Range("Discount \u03b3", 0.0, 1.0, 0.01),
    "eta": Range("Decay \u03b7 per step", 0.0, 1.0, 1e-5),
    "alpha_max": Range("Initial learning rate \u03b1", QLearning.alpha_min, 1.0, 0.05),
    "epsilon_max": Range("Initial exploration \u03b5", QLearning.epsilon_min, 1.0, 0.05),
    "initial_q": Range("Initial Q", -1e9, 1e9, 10.0),
    "goal_reward": Range("Goal reward", -1e9, 1e9, 100.0),
}
