"""Moves the hips of a movement so that the person would not fall. Metres; room frame: Y up."""

import numpy as np

# Share of the mass, and where its centre lies from the first joint to the second (de Leva 1996, women).
TRUNK = (0.4257, "Neck", "hips", 0.4151)
HEAD = (0.0668, "Neck", "Head", 1.0)
LIMBS = [(0.0255, "Arm", "ForeArm", 0.5754), (0.0138, "ForeArm", "Hand", 0.4559), (0.0056, "Hand", "Hand", 0.0),
         (0.1478, "UpLeg", "Leg", 0.3612), (0.0481, "Leg", "Foot", 0.4416), (0.0129, "Foot", "Foot", 0.0)]
AHEAD = 0.028  # of the height: where the mass is above a foot, in front of its ankle
SPREAD_M = 0.012  # standard deviation of that, from person to person
SMOOTH_S = 0.25  # standard deviation in time: nobody balances every moment of a step
LIFTED_M = 0.03  # a foot that is so high does not stand
LEAST_SHARE = 0.05  # of a foot in the support
ROUNDS = 3  # the legs and feet do not go along with the hips


def mass_centre(joints, at):
    """joints [bones x 3], at: name -> bone."""
    places = {name: joints[bone] for name, bone in at.items()}
    places["hips"] = (places["LeftUpLeg"] + places["RightUpLeg"]) / 2
    segments = [TRUNK, HEAD]
    for side in ("Left", "Right"):
        segments += [(mass, side + a, side + b, share) for mass, a, b, share in LIMBS]
    centres = [mass * ((1 - share) * places[a] + share * places[b]) for mass, a, b, share in segments]
    return np.sum(centres, axis=0) / sum(mass for mass, *_ in segments)


def smoothed(values, frames):
    """[f x k] values, blurred over time; both ends go on as they are."""
    reach = int(4 * frames)
    window = np.exp(-0.5 * (np.arange(-reach, reach + 1) / frames) ** 2)
    padded = np.pad(values, ((reach, reach), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, window / window.sum(), "valid") for column in padded.T], axis=1)


def balance(poser, sequence, feet, fps, random):
    """Changes x and z of the postures: the mass comes to lie above the feet that stand."""
    tall = poser.actor.vertices[:, 1].max()
    ahead = AHEAD * tall + random.normal(0, SPREAD_M)
    supports = []
    for frame in range(len(sequence)):
        stands = [LEAST_SHARE + max(0.0, 1 - lift / LIFTED_M) for lift in feet.lifts(frame)]
        points = [ankle + ahead * np.array([np.sin(yaw), 0, np.cos(yaw)]) for ankle, yaw, _ in feet.at(frame)]
        supports.append(sum(s * p for s, p in zip(stands, points)) / sum(stands))
    for _ in range(ROUNDS):
        centres = [mass_centre(poser.pose(posture, feet.at(frame))[1], poser.at)
                   for frame, posture in enumerate(sequence)]
        moves = smoothed(np.array(supports) - centres, SMOOTH_S * fps)
        for posture, move in zip(sequence, moves):
            posture["x"] += move[0]
            posture["z"] += move[2]
