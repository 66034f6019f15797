"""Movements: where someone is, how the trunk and the arms go, and which steps the feet take for it.

A movement is a list of keys, each with a time in seconds and what changes; between them cubic curves. Lengths in
metres, angles in degrees here, radians in what postures() returns.
"""

import numpy as np

REST = dict(x=0, z=0, yaw=0, lean=0, tilt=0, dip=0, bend=0, twist=0, look=0,
            la=14, lf=4, le=18, ra=14, rf=4, re=18)  # left and right arm: abduction, flexion, elbow
ANGLES = set(REST) - {"x", "z", "dip"}
STEP_S = 0.46  # from one foot's step to the next one's
LIFT_M = 0.07  # of the ankle
TOES_DOWN = 0.4  # rad, half way
PIVOTS = 0.5  # rad: a foot that the hips turn farther from pivots along


def key(t, **changes):
    return t, changes


MOVEMENTS = {
    "walk": [  # an arc, and once around
        key(0, x=-0.45, z=-0.9, yaw=30), key(0.6), key(1.6, x=-0.25, z=-0.4, yaw=35, twist=6),
        key(2.6, x=0.1, z=0, yaw=50),
        key(3.0, x=0.2, z=0.05, yaw=80, twist=10), key(5.2, x=0.25, z=0, yaw=390, la=35, ra=35), key(5.8, yaw=395)],
    "sway": [  # half squats and turns both ways, arms out
        key(0), key(0.7, x=0.06, tilt=3, la=40, ra=40), key(1.4, x=-0.06, tilt=-3, dip=0.06, la=60, le=40, ra=50),
        key(2.1, x=0.04, dip=0.16, bend=14, yaw=25, lf=40, rf=40, le=60, re=60),
        key(2.9, x=0, yaw=50, twist=15, la=75, ra=70),
        key(3.7, yaw=-20, twist=-15, dip=0.05, la=30, ra=30), key(4.4, yaw=-45, x=-0.03, ra=110, re=50),
        key(5.2, yaw=0)],
    "turn": [  # steps aside and turns by 180 degrees, fast back
        key(0), key(0.8, x=0.3, la=25), key(1.3, x=0.35, yaw=0, ra=60, re=70), key(2.6, x=0.1, yaw=180, la=45, ra=20),
        key(3.2, yaw=185), key(4.2, x=-0.1, yaw=360, la=50, ra=50), key(4.8, x=-0.1, yaw=360)],
    "squat": [  # squats, a lunge
        key(0), key(0.5), key(1.3, dip=0.3, lean=28, bend=8, lf=75, rf=75, le=20, re=20),
        key(2.1, dip=0, lean=0, bend=0, lf=10, rf=10),
        key(2.9, z=0.32, dip=0.1, lf=-20, rf=50, re=80), key(3.5, z=0.3, dip=0.12), key(4.3, z=0, lf=4, rf=4)],
    "wave": [  # arms overhead, waves, hips swing
        key(0), key(0.9, la=120, ra=30), key(1.5, la=160, le=30, x=0.05, tilt=4, ra=150, re=25),
        key(2.1, x=-0.06, tilt=-4, la=130, le=60),
        key(2.7, x=0.05, tilt=4, la=160, le=20, ra=60, re=90, yaw=20),
        key(3.3, la=30, x=-0.04, tilt=-3, ra=45, re=110, rf=25),
        key(4.0, x=0, yaw=-25, twist=-12, la=60, lf=50, le=70), key(4.8, yaw=0)],
    "dance": [  # hips swing wide and fast, once around
        key(0), key(0.5, x=0.06, tilt=4, yaw=12, twist=8, la=70, ra=50, re=40),
        key(0.9, x=-0.1, tilt=-5, dip=0.05, yaw=-20, twist=-10, la=120, ra=60, re=80),
        key(1.3, x=0.12, z=0.1, tilt=5, dip=0, yaw=10, twist=6, la=60, le=80, lf=40, ra=80),
        key(2.8, x=0, z=0, tilt=0, yaw=-350, twist=0, la=70, le=30, lf=0, ra=65, re=30),
        key(3.3, x=-0.08, tilt=-4, dip=0.06, yaw=-380, la=40, ra=110), key(3.9, x=0, tilt=0, dip=0, yaw=-360)],
    "stroll": [  # to the camera and back in slow steps, looking around
        key(0, z=-0.7), key(0.5, z=-0.7), key(2.4, z=0.15, x=0.1, look=20, yaw=8, twist=5),
        key(3.0, yaw=-15, look=-25, re=70, rf=30),
        key(4.6, z=-0.6, x=-0.1, yaw=-20, look=0), key(5.2, z=-0.62, yaw=0)],
}


def curve(times, values, t):
    """Cubic Hermite through the keys, tangents from the neighbours, at rest at both ends."""
    times, values = np.asarray(times, float), np.asarray(values, float)
    tangents = np.zeros(len(times))
    for i in range(1, len(times) - 1):
        left, right = values[i] - values[i - 1], values[i + 1] - values[i]
        if left * right > 0:  # no overshoot at turning points
            tangents[i] = 2 / ((times[i] - times[i - 1]) / left + (times[i + 1] - times[i]) / right)
    t = np.clip(t, times[0], times[-1])
    i = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2)
    h = times[i + 1] - times[i]
    s = (t - times[i]) / h
    return ((1 + 2 * s) * (1 - s) ** 2 * values[i] + s * (1 - s) ** 2 * h * tangents[i]
            + s * s * (3 - 2 * s) * values[i + 1] + s * s * (s - 1) * h * tangents[i + 1])


def postures(name, fps, crouch, pace=1.0):
    """Postures of all frames of a movement (posing.py). crouch: metres that the hips are lower than on straight legs;
    pace: 2 is twice as fast."""
    keys = MOVEMENTS[name]
    times = [t / pace for t, _ in keys]
    state, columns = dict(REST), {field: [] for field in REST}
    for _, changes in keys:
        state.update(changes)
        for field in REST:
            columns[field].append(state[field])
    result = []
    for t in np.arange(0, times[-1] + 0.5 / fps, 1 / fps):
        posture = {f: curve(times, columns[f], t) * (np.pi / 180 if f in ANGLES else 1) for f in REST}
        posture["dip"] += crouch
        posture["arms"] = [[posture[side + part] for part in "afe"] for side in "lr"]
        result.append(posture)
    return result


class Feet:
    """Plants the feet and lets them step in turns wherever the hips go, and pivot where those turn too far."""

    def __init__(self, poser, sequence, fps):
        self.poser, self.fps, self.sequence = poser, fps, sequence
        first = [self._ideal(side, 0) for side in (0, 1)]
        self.steps = [[(-1.0, 0.0, first[side], first[side])] for side in (0, 1)]  # begin, end, from, to
        t, side, end = 0.0, 0, (len(sequence) - 1) / fps
        while t < end:
            for tried in (side, 1 - side):
                here = self.steps[tried][-1][3]
                there = self._ideal(tried, t + 1.5 * STEP_S)
                if np.linalg.norm(there[0] - here[0]) > 0.05 or abs(there[1] - here[1]) > 0.15:
                    self.steps[tried].append((t, t + 0.9 * STEP_S, here, there))
                    t, side = t + STEP_S, 1 - tried
                    break
            else:
                t += 1 / fps

    def _ideal(self, side, t):
        posture = self.sequence[min(int(round(t * self.fps)), len(self.sequence) - 1)]
        return self.poser.stance(side, posture["x"], posture["z"], posture["yaw"]), posture["yaw"]

    def at(self, frame):
        """(ankle [3], yaw, toes_down) of both feet."""
        hips_yaw = self.sequence[min(frame, len(self.sequence) - 1)]["yaw"]
        feet = [self._foot(side, frame / self.fps) for side in (0, 1)]
        return [(ankle, np.clip(yaw, hips_yaw - PIVOTS, hips_yaw + PIVOTS), toes) for ankle, yaw, toes in feet]

    def lifts(self, frame):
        """How far both ankles are above where they stand."""
        return [ankle[1] - self.poser.ankles[side][1] for side, (ankle, _, _) in enumerate(self.at(frame))]

    def _foot(self, side, t):
        begin, end, (place, yaw), (to_place, to_yaw) = [s for s in self.steps[side] if s[0] <= t][-1]
        if t >= end:
            return to_place, to_yaw, 0.0
        s = (t - begin) / (end - begin)
        eased = s * s * (3 - 2 * s)
        lifted = place + eased * (to_place - place) + np.array([0, LIFT_M * np.sin(np.pi * s), 0])
        toes_down = TOES_DOWN * np.sin(np.pi * s) * (1.3 - 0.6 * s)  # toes leave last, are some 10 mm up half way
        return lifted, yaw + eased * (to_yaw - yaw), toes_down
